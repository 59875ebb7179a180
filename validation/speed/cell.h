/* The affine maps of a cell for cases beside one another, by Gauss collocation. */

#include <math.h>

#define LANES 32 /* as `validation.speed.limit` has it */
#define MOST 10 /* stages */

#define EACH for (int l = 0; l < LANES; l++)

static void cell(int s, double h, const double *matrix, const double (*push)[LANES],
                 const double (*rate)[LANES], double (*gain)[LANES], double (*shift)[LANES]) {
  double system[MOST][MOST][LANES];
  for (int j = 0; j < s; j++) {
    EACH gain[j][l] = 1.0, shift[j][l] = 0.0;
    for (int i = 0; i < s; i++) {
      double step = h * matrix[j * s + i];
      EACH {
        shift[j][l] += step * push[i][l];
        system[j][i][l] = (i == j) - step * rate[i][l];
      }
    }
  }
  for (int k = 0; k < s; k++)
    for (int j = k + 1; j < s; j++) {
      double factor[LANES];
      EACH factor[l] = system[j][k][l] / system[k][k][l];
      for (int i = k + 1; i < s; i++) EACH system[j][i][l] -= factor[l] * system[k][i][l];
      EACH gain[j][l] -= factor[l] * gain[k][l], shift[j][l] -= factor[l] * shift[k][l];
    }
  for (int k = s - 1; k >= 0; k--) {
    for (int i = k + 1; i < s; i++)
      EACH {
        gain[k][l] -= system[k][i][l] * gain[i][l];
        shift[k][l] -= system[k][i][l] * shift[i][l];
      }
    EACH gain[k][l] /= system[k][k][l], shift[k][l] /= system[k][k][l];
  }
}

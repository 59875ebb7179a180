/* The limit for many runs of one machine over many periods: affine cells, found once, runs
 * beside one another; time by quadrature of sqrt(J / 2 E).
 *
 * Out: the energy at the end, and how long it takes. Forwards; no measure, no error. Included is how
 * a cell's maps are made. */

#include "cell.h"

/* Only starts differ: one set of maps for all. room : (3 m s + 2 m) numbers */
void carry_alike(int cases, int m, int s, int periods, const double *rule, const double *width,
                 const double *inertia, const double *torque, const double *given,
                 const double *starts, double *room, double *found) {
  const double *weights = rule + s * s;
  double *gains = room, *shifts = gains + m * s, *shares = shifts + m * s;
  double *growths = shares + m * s, *rises = growths + m;
  for (int c = 0; c < m; c++) {
    double push[MOST][LANES], rate[MOST][LANES], gain[MOST][LANES], shift[MOST][LANES];
    for (int j = 0; j < s; j++)
      EACH {
        push[j][l] = torque[c * s + j] + given[1];
        rate[j][l] = 2.0 * given[2] / (inertia[c * s + j] + given[0]);
      }
    cell(s, width[c], rule, push, rate, gain, shift);
    growths[c] = rises[c] = 0.0;
    for (int j = 0; j < s; j++) {
      double part = width[c] * weights[j];
      gains[c * s + j] = gain[j][0], shifts[c * s + j] = shift[j][0];
      shares[c * s + j] = part * part * 0.5 * (inertia[c * s + j] + given[0]);
      growths[c] += part * rate[j][0] * gain[j][0];
      rises[c] += part * (push[j][0] + rate[j][0] * shift[j][0]);
    }
  }
  for (int first = 0; first < cases; first += LANES) {
    double at[LANES], time[LANES];
    EACH at[l] = starts[first + l < cases ? first + l : cases - 1], time[l] = 0.0;
    for (int p = 0; p < periods; p++)
      for (int c = 0; c < m; c++) {
        for (int j = c * s; j < (c + 1) * s; j++)
          EACH time[l] += sqrt(shares[j] / (gains[j] * at[l] + shifts[j]));
        EACH at[l] += growths[c] * at[l] + rises[c];
      }
    for (int l = 0; l < LANES && first + l < cases; l++)
      found[2 * (first + l)] = at[l], found[2 * (first + l) + 1] = time[l];
  }
}

/* Inertia and loads differ: maps for each. room : (3 m s + 2 m) LANES numbers */
void carry_each(int cases, int m, int s, int periods, const double *rule, const double *width,
                const double *inertia, const double *torque, const double *given,
                const double *starts, double *room, double *found) {
  const double *weights = rule + s * s;
  double(*gains)[LANES] = (double(*)[LANES])room, (*shifts)[LANES] = gains + m * s;
  double(*shares)[LANES] = shifts + m * s, (*growths)[LANES] = shares + m * s;
  double(*rises)[LANES] = growths + m;
  for (int first = 0; first < cases; first += LANES) {
    double own[LANES], c0[LANES], c2[LANES], at[LANES], time[LANES];
    EACH {
      int k = first + l < cases ? first + l : cases - 1;
      own[l] = given[3 * k], c0[l] = given[3 * k + 1], c2[l] = given[3 * k + 2];
      at[l] = starts[k], time[l] = 0.0;
    }
    for (int c = 0; c < m; c++) {
      double push[MOST][LANES], rate[MOST][LANES];
      double(*gain)[LANES] = gains + c * s, (*shift)[LANES] = shifts + c * s;
      for (int j = 0; j < s; j++)
        EACH {
          push[j][l] = torque[c * s + j] + c0[l];
          rate[j][l] = 2.0 * c2[l] / (inertia[c * s + j] + own[l]);
        }
      cell(s, width[c], rule, push, rate, gain, shift);
      EACH growths[c][l] = rises[c][l] = 0.0;
      for (int j = 0; j < s; j++) {
        double part = width[c] * weights[j];
        EACH {
          shares[c * s + j][l] = part * part * 0.5 * (inertia[c * s + j] + own[l]);
          growths[c][l] += part * rate[j][l] * gain[j][l];
          rises[c][l] += part * (push[j][l] + rate[j][l] * shift[j][l]);
        }
      }
    }
    for (int p = 0; p < periods; p++)
      for (int c = 0; c < m; c++) {
        for (int j = c * s; j < (c + 1) * s; j++)
          EACH time[l] += sqrt(shares[j][l] / (gains[j][l] * at[l] + shifts[j][l]));
        EACH at[l] += growths[c][l] * at[l] + rises[c][l];
      }
    for (int l = 0; l < LANES && first + l < cases; l++)
      found[2 * (first + l)] = at[l], found[2 * (first + l) + 1] = time[l];
  }
}

/* The limit for many settled motions: affine cells of one machine, cases beside one another.
 *
 * Each case has its own inertia of the crank and its own loads c0 + c2 omega^2. Out: the energy
 * where the period begins, and at all nodes, in the first part of the room. Forwards; no measure, no
 * error. */

#include "cell.h"

/* room : (2 m s + 2 m) LANES numbers */
void settle(int cases, int m, int s, const double *rule, const double *width,
            const double *inertia, const double *torque, const double *given, double *room,
            double *found) {
  const double *matrix = rule, *weights = rule + s * s;
  double(*gains)[LANES] = (double(*)[LANES])room, (*shifts)[LANES] = gains + m * s;
  double(*maps)[LANES] = shifts + m * s;
  for (int first = 0; first < cases; first += LANES) {
    double own[LANES], c0[LANES], c2[LANES], growth[LANES], rise[LANES], at[LANES];
    EACH {
      const double *one = given + 3 * (first + l < cases ? first + l : cases - 1);
      own[l] = one[0], c0[l] = one[1], c2[l] = one[2];
      growth[l] = rise[l] = 0.0;
    }
    for (int c = 0; c < m; c++) {
      double push[MOST][LANES], rate[MOST][LANES], more[LANES], gained[LANES];
      double(*gain)[LANES] = gains + c * s, (*shift)[LANES] = shifts + c * s;
      for (int j = 0; j < s; j++)
        EACH {
          push[j][l] = torque[c * s + j] + c0[l];
          rate[j][l] = 2.0 * c2[l] / (inertia[c * s + j] + own[l]);
        }
      cell(s, width[c], matrix, push, rate, gain, shift);
      EACH more[l] = gained[l] = 0.0;
      for (int j = 0; j < s; j++)
        EACH {
          double part = width[c] * weights[j];
          more[l] += part * rate[j][l] * gain[j][l];
          gained[l] += part * (push[j][l] + rate[j][l] * shift[j][l]);
        }
      EACH {
        maps[2 * c][l] = more[l], maps[2 * c + 1][l] = gained[l];
        growth[l] += more[l] + growth[l] * more[l];
        rise[l] += gained[l] + more[l] * rise[l];
      }
    }
    EACH at[l] = -rise[l] / growth[l];
    for (int l = 0; l < LANES && first + l < cases; l++) found[first + l] = at[l];
    for (int c = 0; c < m; c++) {
      for (int j = 0; j < s; j++)
        EACH gains[c * s + j][l] = gains[c * s + j][l] * at[l] + shifts[c * s + j][l];
      EACH at[l] += maps[2 * c][l] * at[l] + maps[2 * c + 1][l];
    }
  }
}

/* One slider-crank by hand: what a compiled program without any generality needs.
   Gauss collocation over the crank angle with the maps of one period reused, and DOP853 in time
   with a fixed step. Both return their evaluations, or -1 where they cannot go on. */

#include <math.h>
#include <stdlib.h>

enum { GAUSS = 4, STAGES = 12 }; /* stages of either method */

/* numbers: those of reduced.py, in their order; n cubics of the gas force over the knots */
typedef struct {
    const double *numbers, *knots, *force;
    int n;
} machine_t;

/* J, its half derivative, and the torque of gas and gravity */
typedef struct {
    double inertia, change, torque;
} reduced_t;

static reduced_t reduce(const machine_t *m, double theta, double gas)
{
    const double *p = m->numbers;
    const double r = p[0], l = p[1], e = p[2], a = p[3], rod = p[4], turn = p[5], piston = p[6];
    const double s = sin(theta), c = cos(theta), sb = (r * s - e) / l, cb = sqrt(1.0 - sb * sb);
    const double b1 = r * c / (l * cb), b2 = (sb * b1 * b1 - r * s / l) / cb;
    const double curve = cb * b1 * b1 + sb * b2;
    const double x1 = -r * s - l * sb * b1, x2 = -r * c - l * curve;
    const double u1 = -r * s - a * sb * b1, u2 = -r * c - a * curve;
    const double v1 = r * c - a * cb * b1, v2 = -r * s - a * (cb * b2 - sb * b1 * b1);
    reduced_t q;
    q.inertia = p[7] + rod * (u1 * u1 + v1 * v1) + turn * b1 * b1 + piston * x1 * x1;
    q.change = rod * (u1 * u2 + v1 * v2) + turn * b1 * b2 + piston * x1 * x2;
    q.torque = rod * (p[9] * u1 + p[10] * v1) + piston * p[9] * x1 + p[8] * (p[10] * c - p[9] * s)
               - gas * x1;
    return q;
}

static double cubic(const machine_t *m, int k, double x)
{
    const double *f = m->force + k;
    return ((f[0] * x + f[m->n]) * x + f[2 * m->n]) * x + f[3 * m->n];
}

/* The angle within the table's period. */
static double within(const machine_t *m, double theta)
{
    const double first = m->knots[0], period = m->knots[m->n] - first;
    return theta - period * floor((theta - first) / period);
}

static int piece_at(const machine_t *m, double angle, int k)
{
    while (k > 0 && angle < m->knots[k]) k--;
    while (k < m->n - 1 && angle >= m->knots[k + 1]) k++;
    return k;
}

/* dE/dtheta = push - (2 c2 / J) E is linear: over a cell, E at its nodes and end is affine in E
   at its beginning. root: sqrt(J / 2) at the nodes, so that dt/dtheta = root / sqrt(E). */
typedef struct {
    double gain, shift, node_gain[GAUSS], node_shift[GAUSS], root[GAUSS];
} map_t;

typedef struct {
    const double *nodes, *matrix, *weights;
} rule_t;

static void make_map(const machine_t *m, const rule_t *g, int piece, double angle, double h,
                     map_t *map)
{
    enum { s = GAUSS };
    double rows[s][s + 2], push[s], rate[s];
    for (int i = 0; i < s; i++) {
        const double at = angle + h * g->nodes[i];
        const reduced_t q = reduce(m, at, cubic(m, piece, at - m->knots[piece]));
        push[i] = q.torque + m->numbers[11];
        rate[i] = -2.0 * m->numbers[13] / q.inertia;
        map->root[i] = sqrt(0.5 * q.inertia);
    }
    for (int i = 0; i < s; i++) {
        rows[i][s] = 1.0, rows[i][s + 1] = 0.0;
        for (int j = 0; j < s; j++) {
            rows[i][j] = (i == j) - h * g->matrix[i * s + j] * rate[j];
            rows[i][s + 1] += h * g->matrix[i * s + j] * push[j];
        }
    }
    for (int k = 0; k < s; k++) /* near the identity: no pivots needed */
        for (int i = 0; i < s; i++) {
            const double f = rows[i][k] / rows[k][k];
            if (i != k)
                for (int j = k; j < s + 2; j++) rows[i][j] -= f * rows[k][j];
        }
    map->gain = 1.0, map->shift = 0.0;
    for (int i = 0; i < s; i++) {
        map->node_gain[i] = rows[i][s] / rows[i][i];
        map->node_shift[i] = rows[i][s + 1] / rows[i][i];
        map->gain += h * g->weights[i] * rate[i] * map->node_gain[i];
        map->shift += h * g->weights[i] * (push[i] + rate[i] * map->node_shift[i]);
    }
}

static double duration(const rule_t *g, const map_t *map, double h, double energy)
{
    double sum = 0.0;
    for (int i = 0; i < GAUSS; i++)
        sum += g->weights[i] * map->root[i] / sqrt(map->node_gain[i] * energy + map->node_shift[i]);
    return h * sum;
}

int theta_gauss(const double *numbers, const double *knots, const double *force, int n,
                const double *nodes, const double *matrix, const double *weights, double widest,
                double end, double *state)
{
    const machine_t m = {numbers, knots, force, n};
    const rule_t g = {nodes, matrix, weights};
    int cells = 0;
    for (int k = 0; k < n; k++) cells += (int)ceil((knots[k + 1] - knots[k]) / widest);
    double *edges = malloc((cells + 1) * sizeof *edges);
    int *pieces = malloc(cells * sizeof *pieces);
    map_t *maps = malloc(cells * sizeof *maps), part;
    int made = 0;
    for (int k = 0, c = 0; k < n; k++) {
        const double width = knots[k + 1] - knots[k];
        const int parts = (int)ceil(width / widest);
        for (int i = 0; i < parts; i++, c++) edges[c] = knots[k] + width * i / parts, pieces[c] = k;
    }
    edges[cells] = knots[n];
    for (int c = 0; c < cells; c++) maps[c].gain = 0.0; /* not made yet */

    double angle = within(&m, state[0]), theta = state[0], time = 0.0;
    double energy = 0.5 * reduce(&m, angle, 0.0).inertia * state[1] * state[1];
    int c = 0;
    while (c < cells - 1 && angle >= edges[c + 1]) c++;
    for (;;) {
        double h = edges[c + 1] - angle;
        map_t *map = &maps[c];
        if (angle != edges[c]) make_map(&m, &g, pieces[c], angle, h, map = &part), made++;
        else if (map->gain == 0.0) make_map(&m, &g, pieces[c], angle, h, map), made++;
        const double spent = duration(&g, map, h, energy);
        if (!(map->gain * energy + map->shift > 0.0) || isnan(spent)) { made = -1; break; }
        if (time + spent >= end) { /* the last cell is cut where the time is up */
            double late = time + spent - end, last = map->gain * energy + map->shift;
            for (int k = 0; k < 20 && fabs(late) > 1e-16 * end; k++, made++) {
                h -= late * sqrt(2.0 * last / reduce(&m, angle + h, 0.0).inertia);
                make_map(&m, &g, pieces[c], angle, h, &part);
                last = part.gain * energy + part.shift;
                late = time + duration(&g, &part, h, energy) - end;
            }
            state[0] = theta + h;
            state[1] = sqrt(2.0 * last / reduce(&m, angle + h, 0.0).inertia);
            break;
        }
        energy = map->gain * energy + map->shift;
        time += spent, theta += h;
        c = c + 1 < cells ? c + 1 : 0;
        angle = edges[c];
    }
    free(edges), free(pieces), free(maps);
    return made < 0 ? -1 : made * GAUSS;
}

int dop853(const double *numbers, const double *knots, const double *force, int n, const double *A,
           const double *B, double per_run, double end, double *state)
{
    const machine_t m = {numbers, knots, force, n};
    const int steps = (int)per_run;
    const double h = end / steps;
    double theta = state[0], omega = state[1], speed[STAGES], rate[STAGES];
    int piece = 0;
    for (int k = 0; k < steps; k++) {
        for (int i = 0; i < STAGES; i++) {
            double q = 0.0, w = 0.0;
            for (int j = 0; j < i; j++) {
                q += A[STAGES * i + j] * speed[j];
                w += A[STAGES * i + j] * rate[j];
            }
            const double at = within(&m, theta + h * q);
            w = omega + h * w;
            piece = piece_at(&m, at, piece);
            const reduced_t r = reduce(&m, at, cubic(&m, piece, at - knots[piece]));
            const double load = numbers[11] - (numbers[12] + numbers[13] * fabs(w)) * w;
            speed[i] = w, rate[i] = (r.torque + load - r.change * w * w) / r.inertia;
        }
        double q = 0.0, w = 0.0;
        for (int i = 0; i < STAGES; i++) q += B[i] * speed[i], w += B[i] * rate[i];
        theta += h * q, omega += h * w;
    }
    state[0] = theta, state[1] = omega;
    return isnan(omega) ? -1 : STAGES * steps;
}

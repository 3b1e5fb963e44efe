"""The fixed part of the emitted C++ program."""

PROGRAM = r"""
// As wide as the machine's registers: wider vectors are taken apart again, which takes the compiler three times as long.
#ifdef __AVX512F__
#define VECTOR_BYTES 64
#else
#define VECTOR_BYTES 32
#endif
#define LANES (VECTOR_BYTES / (long)sizeof(real))
typedef real vec __attribute__((vector_size(VECTOR_BYTES)));
typedef decltype(vec() < vec()) mask;
// Loops over states, outputs and tiles must be written out for their arrays to live in registers; not beyond 16 turns, for long programs.
#define UNROLL _Pragma("GCC unroll 16")
#define INLINE static inline __attribute__((always_inline))

#ifdef VECTOR_MATH
#define SIMD __attribute__((simd("notinbranch")))
#else
#define SIMD
#endif
extern "C" {
SIMD double exp(double); SIMD double log(double); SIMD double sin(double); SIMD double cos(double); SIMD double tan(double);
SIMD double asin(double); SIMD double acos(double); SIMD double atan(double); SIMD double sinh(double); SIMD double cosh(double);
SIMD double tanh(double); SIMD double erf(double); SIMD double log1p(double); SIMD double expm1(double); SIMD double pow(double, double);
SIMD double atan2(double, double);
SIMD float expf(float); SIMD float logf(float); SIMD float sinf(float); SIMD float cosf(float); SIMD float tanf(float);
SIMD float asinf(float); SIMD float acosf(float); SIMD float atanf(float); SIMD float sinhf(float); SIMD float coshf(float);
SIMD float tanhf(float); SIMD float erff(float); SIMD float log1pf(float); SIMD float expm1f(float); SIMD float powf(float, float);
SIMD float atan2f(float, float);
double sqrt(double); float sqrtf(float); double floor(double); float floorf(float);
void *aligned_alloc(unsigned long, unsigned long); void free(void *);
}
#define LIFT_AS(name, lifted) \
  INLINE double s_##name(double a) { return name(a); } INLINE float s_##name(float a) { return name##f(a); } \
  INLINE vec lifted(vec a) { vec r; for (int l = 0; l < LANES; l++) r[l] = s_##name((real)a[l]); return r; }
#define LIFT(name) LIFT_AS(name, v_##name)
LIFT_AS(exp, normal_exp) LIFT(log) LIFT(sin) LIFT(cos) LIFT(tan) LIFT(asin) LIFT(acos) LIFT(atan) LIFT(sinh) LIFT(cosh) LIFT(tanh) LIFT(erf)
LIFT(log1p) LIFT(expm1) LIFT(sqrt) LIFT(floor)
#define LIFT2(name) \
  INLINE double s_##name(double a, double b) { return name(a, b); } INLINE float s_##name(float a, float b) { return name##f(a, b); } \
  INLINE vec v_##name(vec a, vec b) { vec r; for (int l = 0; l < LANES; l++) r[l] = s_##name((real)a[l], (real)b[l]); return r; }
LIFT2(pow) LIFT2(atan2)
INLINE vec splat(double a) { return (real)a - vec{}; }
INLINE vec choose(mask m, vec a, vec b) { return m ? a : b; }
INLINE vec v_abs(vec a) { return a < 0 ? -a : a; }
INLINE vec v_sign(vec a) { return (a > 0 ? splat(1) : splat(0)) - (a < 0 ? splat(1) : splat(0)); }
// What would be no normal number is zero: the vector library computes subnormal numbers lane by lane, five times as slowly.
INLINE vec v_exp(vec a) {
  const vec least = splat(sizeof(real) == 8 ? -708 : -87);
  return a < least ? vec{} : normal_exp(a < least ? least : a);
}
INLINE vec v_min(vec a, vec b) { return a < b ? a : b; }
INLINE vec v_max(vec a, vec b) { return a > b ? a : b; }

INLINE void prologue(const vec *p, vec *h) {
/*PROLOGUE*/
}
static __attribute__((noinline)) void rates(const vec *x, const vec *u, const vec *p, const vec *h, vec *dx) {
/*RATES*/
}
static __attribute__((noinline)) void rates_jacobian(const vec *x, const vec *u, const vec *p, const vec *h, vec *dx, vec *A, vec (*B)[4]) {
/*RATES_JACOBIAN*/
}
INLINE void outputs(const vec *x, const vec *u, const vec *p, const vec *h, vec *y) {
/*OUTPUTS*/
}
INLINE void outputs_jacobian(const vec *x, const vec *u, const vec *p, const vec *h, vec *y, vec *C, vec (*D)[NY]) {
/*OUTPUTS_JACOBIAN*/
}
// Partial derivatives by parameters are kept without zeros: those by parameter c are B[first[c]] to B[first[c + 1] - 1], in rows row[...]; by a
// start state, none.
static const short first[NS + 2] = {/*FIRST_ROWS*/}, row[NB] = {/*ROWS*/};
// Once a step: what takes tangents through it. Then every direction costs one product with S.
static __attribute__((noinline)) void transition(vec H, const vec (*A)[NA], vec (*M)[NT][NT], vec (*S)[NT]) {
/*TRANSITION*/
}
INLINE void tangent_output(const vec *C, const vec *d, const vec *z, vec *s) {
/*TANGENT_OUTPUT*/
}
// Written out: arrays that a loop of unknown length adds to would not live in registers.
INLINE void propagate(const vec (*S)[NT], const vec (*M)[NT][NT], const vec (*B)[4], long c, vec *q) {
/*PROPAGATE*/
}

struct Job {
  long groups, steps, substeps, foh, samples, directions, threads;
  long first, close, band;  // rows of probes before the row close keep their columns before first, and those no farther left than the band
  long every, restarts;    // samples between restarts, and how many there are, the start included; none where null
  const real *u;           // [NU][samples]   recorded inputs, all experiments one after another
  const real *dt;          // [samples]       time to the next sample
  const long *parts;       // [samples] or null: by how many more sub-steps that time is gone through, in gaps
  const long *start;       // [groups][LANES] first sample of each window
  const long *last;        // [groups][LANES] last sample that the window may read
  const long *column;      // [directions]    parameter column, or NS for a start-state direction
  const real *p;           // [groups][NP][LANES]
  real *x;                 // [groups][NX][LANES]              in: start states, out: states after the last step
  real *dx;                // [groups][directions][NT][LANES]  likewise for the tangents
  real *y;                 // [groups][steps][NY][LANES]
  real *dy;                // [groups][steps][NY][directions][LANES], unused where normal is wanted
  real *trace;             // [groups][steps][NX][LANES] or null: states at the samples
  const long *kept;        // [NX]            whether a state goes on at restarts
  real *restart;           // [groups][restarts][NX][LANES] or null, in: where the other states begin anew, out: where those kept are then
  const real *measured;    // [NY][samples] or null: what the outputs are compared with, NaN = missing
  const real *weight;      // [NY]            factor on the errors
  real *normal;            // [groups][…][LANES]: JᵀJ, Jᵀe and eᵀe, lower triangle of tiles: close rows of first + band + TILE, then whole
                           // ones of directions + 1 rounded up to TILE
};

INLINE vec gather(const real *data, const long *index) {
  vec r;
  for (int l = 0; l < LANES; l++) r[l] = data[index[l]];
  return r;
}

#define TILE 4
#define CHUNK 32
INLINE long narrow(const Job &job) { return job.first + job.band + TILE; }
INLINE void accumulate(const vec *rows, long count, long width, vec *normal, const Job &job) {
  for (long i = 0; i < width; i += TILE) {
    const bool apart = i < job.close;
    const long stride = apart ? narrow(job) : width;
    vec *const row = normal + (apart ? i * stride : job.close * narrow(job) + (i - job.close) * width);
    for (long j = 0; j <= i; j += TILE) {
      if (apart && j >= job.first && i - j > job.band) j = i - job.band;
      vec *const tile = row + (apart && j >= job.first ? job.first + job.band - (i - j) : j);
      vec sum[TILE][TILE];
      UNROLL for (int a = 0; a < TILE; a++) UNROLL for (int b = 0; b < TILE; b++) sum[a][b] = tile[a * stride + b];
      for (long t = 0; t < count; t++) {
        const vec *left = rows + t * width + i, *right = rows + t * width + j;
        UNROLL for (int a = 0; a < TILE; a++) UNROLL for (int b = 0; b < TILE; b++) sum[a][b] += left[a] * right[b];
      }
      UNROLL for (int a = 0; a < TILE; a++) UNROLL for (int b = 0; b < TILE; b++) tile[a * stride + b] = sum[a][b];
    }
  }
}

template <bool TANGENTS> static void run_group(const Job &job, long g) {
  vec x[NX], y[NY], u0[NU], u1[NU], uh[NU], h[NH];
  vec A[4][NA], C[NC], M[4][NT][NT], S[NT][NT];
  vec B[NB][4];  // by stage
  static thread_local vec D[NS + 1][NY];
  const long nd = job.directions;
  const vec *p = (const vec *)job.p + g * NP;
  vec *gx = (vec *)job.x + g * NX, *gdx = (vec *)job.dx + g * nd * NT;
  vec *gy = (vec *)job.y + g * job.steps * NY;
  vec *gdy = (vec *)job.dy + g * job.steps * NY * nd;
  vec *gtrace = job.trace ? (vec *)job.trace + g * job.steps * NX : 0;
  const long width = (nd + TILE) / TILE * TILE;
  vec *gnormal = (vec *)job.normal + g * (job.close * narrow(job) + (width - job.close) * width);
  vec *rows = job.normal ? (vec *)aligned_alloc(64, sizeof(vec) * width * CHUNK * NY) : 0;
  long filled = 0;
  if (rows) for (long k = 0; k < width * CHUNK * NY; k++) rows[k] = vec{};
  prologue(p, h);
  for (int k = 0; k <= NS; k++) UNROLL for (int i = 0; i < NY; i++) D[k][i] = vec{};
  UNROLL for (int i = 0; i < NX; i++) x[i] = gx[i];
  for (long n = 0; n < job.steps; n++) {
    if (job.restart && n && n % job.every == 0 && n / job.every < job.restarts) {
      vec *begin = (vec *)job.restart + (g * job.restarts + n / job.every) * NX;
      for (int i = 0; i < NX; i++)
        if (job.kept[i]) begin[i] = x[i] = x[i] == x[i] ? x[i] : vec{};
        else x[i] = begin[i];
    }
    long now[LANES], next[LANES];
    for (int l = 0; l < LANES; l++) {
      long at = job.start[g * LANES + l] + n, end = job.last[g * LANES + l];
      now[l] = at < end ? at : end;
      next[l] = at + 1 < end ? at + 1 : end;
    }
    UNROLL for (int i = 0; i < NU; i++) u0[i] = gather(job.u + i * job.samples, now);
    UNROLL for (int i = 0; i < NU; i++) u1[i] = job.foh ? gather(job.u + i * job.samples, next) : u0[i];
    if (TANGENTS) outputs_jacobian(x, u0, p, h, y, C, D); else outputs(x, u0, p, h, y);
    UNROLL for (int i = 0; i < NY; i++) gy[n * NY + i] = y[i];
    if (gtrace) UNROLL for (int i = 0; i < NX; i++) gtrace[n * NX + i] = x[i];
    vec scale[NY];
    if (rows) UNROLL for (int i = 0; i < NY; i++) {
      const vec target = gather(job.measured + i * job.samples, now);
      for (int l = 0; l < LANES; l++)
        scale[i][l] = job.start[g * LANES + l] + n <= job.last[g * LANES + l] && target[l] == target[l] ? job.weight[i] : 0;
      const vec error = scale[i] != 0 ? (target - y[i]) * scale[i] : vec{};
      rows[(filled + i) * width + nd] = error;
    }
    if (TANGENTS) for (long d = 0; d < nd; d++) {
      vec s[NY];
      tangent_output(C, D[job.column[d]], gdx + d * NT, s);
      if (rows) UNROLL for (int i = 0; i < NY; i++) rows[(filled + i) * width + d] = scale[i] != 0 ? s[i] * scale[i] : vec{};
      else UNROLL for (int i = 0; i < NY; i++) gdy[(n * NY + i) * nd + d] = s[i];
    }
    if (rows && ((filled += NY) == CHUNK * NY || n == job.steps - 1)) {
      accumulate(rows, filled, width, gnormal, job);
      filled = 0;
    }
    long substeps = job.substeps;
    if (job.parts) {
      long most = 1;
      for (int l = 0; l < LANES; l++) most = job.parts[now[l]] > most ? job.parts[now[l]] : most;
      substeps *= most;
    }
    const vec H = gather(job.dt, now) / (real)substeps;
    for (long m = 0; m < substeps; m++) {
      vec a[NU], b[NU], k1[NX], k2[NX], k3[NX], k4[NX], z[NX];
      const real from = (real)m / substeps, middle = ((real)m + (real)0.5) / substeps, to = (real)(m + 1) / substeps;
      UNROLL for (int i = 0; i < NU; i++) {
        a[i] = u0[i] + from * (u1[i] - u0[i]);
        uh[i] = u0[i] + middle * (u1[i] - u0[i]);
        b[i] = u0[i] + to * (u1[i] - u0[i]);
      }
      if (TANGENTS) rates_jacobian(x, a, p, h, k1, A[0], (vec (*)[4])&B[0][0]); else rates(x, a, p, h, k1);
      UNROLL for (int i = 0; i < NX; i++) z[i] = x[i] + (real)0.5 * H * k1[i];
      if (TANGENTS) rates_jacobian(z, uh, p, h, k2, A[1], (vec (*)[4])&B[0][1]); else rates(z, uh, p, h, k2);
      UNROLL for (int i = 0; i < NX; i++) z[i] = x[i] + (real)0.5 * H * k2[i];
      if (TANGENTS) rates_jacobian(z, uh, p, h, k3, A[2], (vec (*)[4])&B[0][2]); else rates(z, uh, p, h, k3);
      UNROLL for (int i = 0; i < NX; i++) z[i] = x[i] + H * k3[i];
      if (TANGENTS) rates_jacobian(z, b, p, h, k4, A[3], (vec (*)[4])&B[0][3]); else rates(z, b, p, h, k4);
      UNROLL for (int i = 0; i < NX; i++) x[i] += H / (real)6 * (k1[i] + (real)2 * (k2[i] + k3[i]) + k4[i]);
      if (TANGENTS) {
        transition(H, A, M, S);
        for (long d = 0; d < nd; d++) {
          propagate(S, M, B, job.column[d], gdx + d * NT);
        }
      }
    }
  }
  UNROLL for (int i = 0; i < NX; i++) gx[i] = x[i];
  free(rows);
}

extern "C" const long lanes = LANES;
extern "C" void run(const Job *job) {
#pragma omp parallel for schedule(dynamic) num_threads(job->threads)
  for (long g = 0; g < job->groups; g++)
    if (job->directions) run_group<true>(*job, g); else run_group<false>(*job, g);
}
"""

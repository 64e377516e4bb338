/* Heat equation in a cube: u_t = a (u_xx + u_yy + u_zz), explicit Euler, u = 0 at the walls. Each rank has layers along
 * z, with one ghost layer at each side. The diffusivity can be changed while it runs.
 *
 *   cc heat.c $(pkg-config --cflags --libs ghostspace-insitu) -lm -o heat && ./heat --serve
 *   mpicc -DEXAMPLE_MPI heat.c $(pkg-config --cflags --libs ghostspace-insitu) -lm -o heat && mpirun -n 4 ./heat
 * --serve
 */
#include "example.h"

#include <math.h>

int main(int argc, char** argv) {
  example e = example_begin(argc, argv, 96);
  const int n = e.size;
  const size_t layer = (size_t)n * (size_t)n;
  int first, end, layers, step;
  double *u, *next, a = 0.1, time = 0;
  example_open(&e, "heat equation");
  example_share(&e, n, &first, &end);
  layers = end - first;
  u = calloc(layer * (size_t)(layers + 2), sizeof *u);
  next = calloc(layer * (size_t)(layers + 2), sizeof *next);
  if (!u || !next || layers < 1) return 1;
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double dx = (double)x / n - 0.35, dy = (double)y / n - 0.5, dz = (double)(z + first) / n - 0.5;
        const double ex = (double)x / n - 0.7, ey = (double)y / n - 0.6;
        u[layer * (size_t)(z + 1) + (size_t)(y * n + x)] =
            100 * exp(-60 * (dx * dx + dy * dy + dz * dz)) + 80 * exp(-150 * (ex * ex + ey * ey + dz * dz));
      }
  if (e.session) {
    gs_insitu_parameter p;
    memset(&p, 0, sizeof p);
    p.size = sizeof p;
    p.name = "diffusivity";
    p.label = "Diffusivity";
    p.minimum = 0;
    p.maximum = 0.16;
    p.value = a;
    gs_insitu_add_parameter(e.session, &p);
  }
  for (step = 0; step < e.steps; ++step) {
    if (e.session) {
      if (gs_insitu_begin_step(e.session, step, time) == GS_INSITU_OK) {
        gs_insitu_field field;
        gs_insitu_block block;
        memset(&field, 0, sizeof field);
        field.name = "temperature";
        field.unit = "K";
        field.data = u;
        field.type = GS_INSITU_FLOAT64;
        memset(&block, 0, sizeof block);
        block.size = sizeof block;
        block.whole_extent[1] = block.whole_extent[3] = block.whole_extent[5] = n - 1;
        block.extent[1] = block.extent[3] = n - 1;
        block.extent[4] = first - 1; /* the outermost ghost layers are outside of the grid */
        block.extent[5] = end;
        block.spacing[0] = block.spacing[1] = block.spacing[2] = 1.0 / n;
        block.ghost[4] = block.ghost[5] = 1;
        block.fields = &field;
        block.field_count = 1;
        gs_insitu_pass_block(e.session, &block);
        gs_insitu_end_step(e.session);
      }
      a = gs_insitu_value(e.session, "diffusivity");
    }
    example_halo(&e, u, layer, layers, 0);
    for (int z = 1; z <= layers; ++z) {
      const double* p = u + layer * (size_t)z;
      double* q = next + layer * (size_t)z;
      if (z + first - 1 == 0 || z + first - 1 == n - 1) continue;
      for (int y = 1; y + 1 < n; ++y)
        for (int x = 1; x + 1 < n; ++x) {
          const size_t i = (size_t)y * (size_t)n + (size_t)x;
          q[i] = p[i] + a * (p[i - 1] + p[i + 1] + p[i - (size_t)n] + p[i + (size_t)n] + p[i + layer] +
                             *(p + i - layer) - 6 * p[i]);
        }
    }
    {
      double* swap = u;
      u = next;
      next = swap;
    }
    time += 1;
    example_pause(&e);
  }
  example_end(&e);
  free(u);
  free(next);
  return 0;
}

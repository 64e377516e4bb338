/* Gray-Scott reaction of two substances U and V in a periodic cube. Feed and kill rates can be changed while it runs.
 *
 *   cc gray_scott.c $(pkg-config --cflags --libs ghostspace-insitu) -lm -o gray_scott && ./gray_scott --serve
 */
#include "example.h"

int main(int argc, char** argv) {
  example e = example_begin(argc, argv, 64);
  const int n = e.size;
  const size_t layer = (size_t)n * (size_t)n;
  int first, end, layers, step;
  double *u, *v, *next_u, *next_v, feed = 0.02, kill = 0.048, time = 0;
  const double du = 0.2, dv = 0.1, dt = 1;
  example_open(&e, "Gray-Scott");
  example_share(&e, n, &first, &end);
  layers = end - first;
  {
    const size_t count = layer * (size_t)(layers + 2);
    u = calloc(count, sizeof *u);
    v = calloc(count, sizeof *v);
    next_u = calloc(count, sizeof *u);
    next_v = calloc(count, sizeof *v);
    if (!u || !v || !next_u || !next_v || layers < 1) return 1;
    for (size_t i = 0; i < count; ++i) u[i] = 1;
  }
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        if (abs(2 * x - n) < n / 4 && abs(2 * y - n) < n / 4 && abs(2 * (z + first) - n) < n / 4) {
          const size_t i = layer * (size_t)(z + 1) + (size_t)(y * n + x);
          u[i] = 0.5 + 0.01 * ((x * 7 + y * 13 + (z + first) * 29) % 10);
          v[i] = 0.25;
        }
  if (e.session) {
    gs_insitu_parameter p;
    memset(&p, 0, sizeof p);
    p.size = sizeof p;
    p.name = "feed";
    p.label = "Feed rate";
    p.minimum = 0;
    p.maximum = 0.1;
    p.value = feed;
    gs_insitu_add_parameter(e.session, &p);
    p.name = "kill";
    p.label = "Kill rate";
    p.value = kill;
    gs_insitu_add_parameter(e.session, &p);
  }
  for (step = 0; step < e.steps; ++step) {
    if (e.session) {
      if (gs_insitu_begin_step(e.session, step, time) == GS_INSITU_OK) {
        gs_insitu_field fields[2];
        gs_insitu_block block;
        memset(fields, 0, sizeof fields);
        fields[0].name = "V";
        fields[0].data = v;
        fields[0].type = GS_INSITU_FLOAT64;
        fields[1].name = "U";
        fields[1].data = u;
        fields[1].type = GS_INSITU_FLOAT64;
        memset(&block, 0, sizeof block);
        block.size = sizeof block;
        block.whole_extent[1] = block.whole_extent[3] = block.whole_extent[5] = n - 1;
        block.extent[1] = block.extent[3] = n - 1;
        block.extent[4] = first - 1;
        block.extent[5] = end;
        block.ghost[4] = block.ghost[5] = 1;
        block.fields = fields;
        block.field_count = 2;
        gs_insitu_pass_block(e.session, &block);
        gs_insitu_end_step(e.session);
      }
      feed = gs_insitu_value(e.session, "feed");
      kill = gs_insitu_value(e.session, "kill");
    }
    example_halo(&e, u, layer, layers, 1);
    example_halo(&e, v, layer, layers, 1);
    for (int z = 1; z <= layers; ++z)
      for (int y = 0; y < n; ++y) {
        const size_t row = layer * (size_t)z + (size_t)y * (size_t)n;
        const size_t up = layer * (size_t)z + (size_t)((y + 1) % n) * (size_t)n;
        const size_t down = layer * (size_t)z + (size_t)((y + n - 1) % n) * (size_t)n;
        for (int x = 0; x < n; ++x) {
          const size_t i = row + (size_t)x, l = row + (size_t)((x + n - 1) % n), r = row + (size_t)((x + 1) % n);
          const size_t b = up + (size_t)x, d = down + (size_t)x;
          const double lu = (u[l] + u[r] + u[b] + u[d] + u[i + layer] + u[i - layer]) / 6 - u[i];
          const double lv = (v[l] + v[r] + v[b] + v[d] + v[i + layer] + v[i - layer]) / 6 - v[i];
          const double uvv = u[i] * v[i] * v[i];
          next_u[i] = u[i] + dt * (du * lu - uvv + feed * (1 - u[i]));
          next_v[i] = v[i] + dt * (dv * lv + uvv - (feed + kill) * v[i]);
        }
      }
    {
      double* swap = u;
      u = next_u;
      next_u = swap;
    }
    {
      double* swap = v;
      v = next_v;
      next_v = swap;
    }
    time += dt;
    example_pause(&e);
  }
  example_end(&e);
  free(u);
  free(v);
  free(next_u);
  free(next_v);
  return 0;
}

/* Particles that orbit a common centre, each on its own circle. Their colours show the speed.
 *
 *   cc particles.c $(pkg-config --cflags --libs ghostspace-insitu) -lm -o particles && ./particles --serve
 */
#include "example.h"

#include <math.h>

int main(int argc, char** argv) {
  example e = example_begin(argc, argv, 16); /* size * size * size particles */
  int first, end, step;
  size_t count, i;
  double time = 0, pace = 1;
  float *positions, *speeds, *radii, *phases, *heights;
  example_open(&e, "particles");
  example_share(&e, e.size, &first, &end);
  count = (size_t)(end - first) * (size_t)e.size * (size_t)e.size;
  positions = calloc(3 * count + 1, sizeof *positions);
  speeds = calloc(count + 1, sizeof *speeds);
  radii = calloc(count + 1, sizeof *radii);
  phases = calloc(count + 1, sizeof *phases);
  heights = calloc(count + 1, sizeof *heights);
  if (!positions || !speeds || !radii || !phases || !heights) return 1;
  for (i = 0; i < count; ++i) {
    /* A low-discrepancy sequence (R3), so that all runs and all numbers of ranks have the same particles. */
    const double k = (double)(i + (size_t)first * (size_t)e.size * (size_t)e.size) + 0.5;
    radii[i] = (float)(0.3 + 3 * fmod(k * 0.8191725133961645, 1));
    phases[i] = (float)(6.283185307 * fmod(k * 0.6710436067037893, 1));
    heights[i] = (float)(0.4 * fmod(k * 0.5497004779019703, 1) - 0.2);
    speeds[i] = (float)(1 / sqrt(radii[i]));
  }
  if (e.session) {
    gs_insitu_parameter p;
    memset(&p, 0, sizeof p);
    p.size = sizeof p;
    p.name = "pace";
    p.label = "Pace";
    p.maximum = 10;
    p.value = pace;
    gs_insitu_add_parameter(e.session, &p);
  }
  for (step = 0; step < e.steps; ++step) {
    for (i = 0; i < count; ++i) {
      const double angle = phases[i] + time * speeds[i] / radii[i];
      positions[3 * i] = (float)(radii[i] * cos(angle));
      positions[3 * i + 1] = heights[i];
      positions[3 * i + 2] = (float)(radii[i] * sin(angle));
    }
    if (e.session) {
      if (gs_insitu_begin_step(e.session, step, time) == GS_INSITU_OK) {
        gs_insitu_field field;
        gs_insitu_particles all;
        memset(&field, 0, sizeof field);
        field.name = "speed";
        field.unit = "m/s";
        field.data = speeds;
        field.type = GS_INSITU_FLOAT32;
        memset(&all, 0, sizeof all);
        all.size = sizeof all;
        all.positions = positions;
        all.position_type = GS_INSITU_FLOAT32;
        all.count = count;
        all.radius = 0.03;
        all.fields = &field;
        all.field_count = 1;
        gs_insitu_pass_particles(e.session, &all);
        gs_insitu_end_step(e.session);
      }
      pace = gs_insitu_value(e.session, "pace");
    }
    time += 0.02 * pace;
    example_pause(&e);
  }
  example_end(&e);
  free(positions);
  free(speeds);
  free(radii);
  free(phases);
  free(heights);
  return 0;
}

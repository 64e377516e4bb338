/* Options that all examples share. */
#pragma once

#include <ghostspace/insitu.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef EXAMPLE_MPI
#include <ghostspace/insitu_mpi.h>
#endif

typedef struct example {
  int size, steps, every, serve, port, pause_ms, background, thin, rank, ranks;
  double share, error;
  const char *folder, *token_file, *live_file;
  gs_insitu* session;
#ifdef EXAMPLE_MPI
  gs_insitu_mpi* mpi;
#endif
} example;

static void example_log(void* context, const char* message) {
  (void)context;
  fprintf(stderr, "insitu: %s\n", message);
}

/* Reads options such as --size 64 --steps 200 --every 10 --folder out --serve --port 8123. Exits on invalid options. */
static example example_begin(int argc, char** argv, int size) {
  example e;
  int i;
  memset(&e, 0, sizeof e);
  e.size = size;
  e.steps = 1000;
  e.every = 1;
  e.ranks = 1;
  e.share = GS_INSITU_USUAL_SHARE;
  for (i = 1; i < argc; ++i) {
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (!strcmp(argv[i], "--serve"))
      e.serve = 1;
    else if (!strcmp(argv[i], "--background"))
      e.background = 1;
    else if (!strcmp(argv[i], "--thin"))
      e.thin = 1;
    else if (!strcmp(argv[i], "--size"))
      e.size = atoi(value), ++i;
    else if (!strcmp(argv[i], "--steps"))
      e.steps = atoi(value), ++i;
    else if (!strcmp(argv[i], "--every"))
      e.every = atoi(value), ++i;
    else if (!strcmp(argv[i], "--port"))
      e.port = atoi(value), ++i;
    else if (!strcmp(argv[i], "--pause"))
      e.pause_ms = atoi(value), ++i;
    else if (!strcmp(argv[i], "--share"))
      e.share = atof(value), ++i;
    else if (!strcmp(argv[i], "--error"))
      e.error = atof(value), ++i;
    else if (!strcmp(argv[i], "--folder"))
      e.folder = value, ++i;
    else if (!strcmp(argv[i], "--token-file"))
      e.token_file = value, ++i;
    else if (!strcmp(argv[i], "--live-file"))
      e.live_file = value, ++i;
    else {
      fprintf(stderr,
              "usage: %s [--size N] [--steps N] [--every N] [--folder DIR] [--serve] [--port N] [--token-file FILE]\n"
              "       [--live-file FILE]\n"
              "       [--share PART] [--error E] [--background] [--thin] [--pause MILLISECONDS]\n",
              argv[0]);
      exit(2);
    }
  }
  if (e.size < 4 || e.size > 4096 || e.steps < 0 || e.every < 1) {
    fprintf(stderr, "expected --size 4 to 4096, --steps 0 or more, and --every 1 or more\n");
    exit(2);
  }
#ifdef EXAMPLE_MPI
  MPI_Init(&argc, &argv);
  e.mpi = gs_insitu_mpi_open(MPI_COMM_WORLD);
  if (!e.mpi) MPI_Abort(MPI_COMM_WORLD, 1);
  e.rank = e.mpi->table.rank;
  e.ranks = e.mpi->table.ranks;
#endif
  return e;
}

/* Opens the session. Without --folder and --serve, opens none, so that the simulation alone can be timed. */
static void example_open(example* e, const char* title) {
  gs_insitu_options options;
  const gs_insitu_communicator* communicator = NULL;
  char error[256];
  if (!e->folder && !e->serve) return;
  gs_insitu_options_init(&options, sizeof options);
  options.title = title;
  options.folder = e->folder;
  options.serve = e->serve;
  options.port = e->port;
  options.token_file = e->token_file;
  options.live_file = e->live_file;
  options.every = e->every;
  options.max_share = e->share;
  options.error = e->error;
  options.background = e->background;
  options.thin = e->thin;
  options.log = example_log;
#ifdef EXAMPLE_MPI
  communicator = &e->mpi->table;
#endif
  e->session = gs_insitu_open(&options, communicator, error, sizeof error);
  if (!e->session) {
    fprintf(stderr, "%s\n", error);
#ifdef EXAMPLE_MPI
    MPI_Abort(MPI_COMM_WORLD, 1);
#endif
    exit(1);
  }
  if (e->serve && e->rank == 0) {
    printf("ghostspace --follow http://127.0.0.1:%d/\n", gs_insitu_port(e->session));
    fflush(stdout);
  }
}

static void example_pause(const example* e) {
  struct timespec wait;
  wait.tv_sec = e->pause_ms / 1000;
  wait.tv_nsec = (e->pause_ms % 1000) * 1000000L;
  if (e->pause_ms > 0) nanosleep(&wait, NULL);
}

/* Ends the session, and prints its cost. */
static void example_end(example* e) {
  gs_insitu_statistics s;
  memset(&s, 0, sizeof s);
  s.size = sizeof s;
  if (e->session) {
    gs_insitu_flush(e->session);
    gs_insitu_get_statistics(e->session, &s);
    printf(
        "rank %d: %llu steps, %llu taken, %.3f of %.3f s in the library (%.2f %%), %.3f s of processor time, "
        "last stream after %.3f s, %llu bytes of streams, %.1f MB of buffers\n",
        e->rank, (unsigned long long)s.steps, (unsigned long long)s.taken, s.own_seconds, s.run_seconds,
        100 * s.own_seconds / (s.run_seconds > 0 ? s.run_seconds : 1), s.processor_seconds, s.last_seconds,
        (unsigned long long)s.stream_bytes, (double)s.peak_bytes / 1e6);
  }
  gs_insitu_close(e->session);
#ifdef EXAMPLE_MPI
  gs_insitu_mpi_close(e->mpi);
  MPI_Finalize();
#endif
}

/* Computes the layers [first, end) of n that this rank owns. */
static void example_share(const example* e, int n, int* first, int* end) {
  *first = (int)((long long)n * e->rank / e->ranks);
  *end = (int)((long long)n * (e->rank + 1) / e->ranks);
}

#ifdef EXAMPLE_MPI
/* Exchanges the outer owned layers of an array with the ghost layers of the neighbours; periodic if `wraps`. */
static void example_halo(const example* e, double* data, size_t layer, int layers, int wraps) {
  const int last = e->ranks - 1;
  const int below = e->rank > 0 ? e->rank - 1 : wraps ? last : MPI_PROC_NULL;
  const int above = e->rank < last ? e->rank + 1 : wraps ? 0 : MPI_PROC_NULL;
  MPI_Sendrecv(data + layer, (int)layer, MPI_DOUBLE, below, 1, data + (size_t)(layers + 1) * layer, (int)layer,
               MPI_DOUBLE, above, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  MPI_Sendrecv(data + (size_t)layers * layer, (int)layer, MPI_DOUBLE, above, 2, data, (int)layer, MPI_DOUBLE, below, 2,
               MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}
#else
static void example_halo(const example* e, double* data, size_t layer, int layers, int wraps) {
  (void)e;
  if (!wraps) return;
  memcpy(data, data + (size_t)layers * layer, layer * sizeof *data);
  memcpy(data + (size_t)(layers + 1) * layer, data + layer, layer * sizeof *data);
}
#endif

/* GhostSpace in situ: a simulation passes its arrays, and viewers see each step. C99 and C++. docs/insitu.md has
 * examples.
 *
 * Rules for all functions:
 * - The library reads arrays of the caller during the call that passes them, or until gs_insitu_end_step() if the
 *   comment of the function says so. It never writes them.
 * - Functions marked "collective" must be called by all ranks in the same order. Others are local.
 * - A handle belongs to one thread at a time. No function throws, exits or writes to standard output.
 * - Communication takes place inside collective functions only, on the calling thread.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. A library of version N accepts programs that were compiled with an older version. */
#define GS_INSITU_VERSION 3

#if defined(__GNUC__)
#define GS_INSITU_API __attribute__((visibility("default")))
#else
#define GS_INSITU_API
#endif

/* Results of functions. Values below 0 are errors; gs_insitu_error() has the message. */
enum gs_insitu_result {
  GS_INSITU_SKIPPED = 0, /* the library does not take this step: pass no arrays */
  GS_INSITU_OK = 1,
  GS_INSITU_INVALID = -1, /* an argument is invalid */
  GS_INSITU_FAILED = -2   /* a file, a socket, memory or the communicator failed */
};

/* Type of the values of an array. */
enum gs_insitu_type {
  GS_INSITU_FLOAT32 = 1,
  GS_INSITU_FLOAT64 = 2,
  GS_INSITU_INT8 = 3,
  GS_INSITU_UINT8 = 4,
  GS_INSITU_INT16 = 5,
  GS_INSITU_UINT16 = 6,
  GS_INSITU_INT32 = 7,
  GS_INSITU_UINT32 = 8,
  GS_INSITU_INT64 = 9,
  GS_INSITU_UINT64 = 10
};

/* Elements to which the values of a field belong. */
enum gs_insitu_association { GS_INSITU_POINTS = 0, GS_INSITU_CELLS = 1 };

/* Named array with one or more numbers per point or cell. Set unused members to 0. */
typedef struct gs_insitu_field {
  const char* name;
  const char* unit; /* or NULL */
  const void* data;
  int32_t type;        /* enum gs_insitu_type */
  int32_t association; /* enum gs_insitu_association */
  int32_t components;  /* numbers per element, 1 to 9; 0 means 1 */
  int32_t reserved;
  /* Distances in bytes, which may be negative. Blocks: between neighbours along x, y and z. Other data: between
   * elements, in strides[0]. strides[3] is for components. If all are 0: no gaps, components vary fastest, then x. */
  int64_t strides[4];
} gs_insitu_field;

/* Block of a regular grid that this rank holds. Indices count the points of the whole grid. */
typedef struct gs_insitu_block {
  size_t size;             /* sizeof(gs_insitu_block) */
  int64_t whole_extent[6]; /* first and last point of the whole grid along x, y, z; equal on all ranks */
  int64_t extent[6];       /* first and last point of the arrays of this block, with ghost layers */
  double origin[3];        /* position of the point with index 0 */
  double spacing[3];       /* distance between neighbouring points; 0 means 1 */
  int32_t ghost[6];        /* layers of points (of cells, for fields of cells) at each side that other blocks own */
  const gs_insitu_field* fields;
  size_t field_count;
} gs_insitu_block;

/* Unstructured cells that this rank holds. The library shows their surface. */
typedef struct gs_insitu_cells {
  size_t size;        /* sizeof(gs_insitu_cells) */
  const void* points; /* x, y, z of each point */
  int32_t point_type; /* GS_INSITU_FLOAT32 or GS_INSITU_FLOAT64 */
  int32_t index_type; /* type of connectivity and offsets: GS_INSITU_INT32 or GS_INSITU_INT64 */
  size_t point_count;
  const void* connectivity;  /* point indices of all cells, one cell after the other */
  size_t connectivity_count; /* number of entries */
  const void* offsets; /* cell_count + 1 positions in `connectivity`: the first is 0, the last is connectivity_count */
  const uint8_t*
      types; /* cell type of VTK for each cell: 5, 7, 8, 9, 10 to 14, 22 to 29; others are counted and left out */
  size_t cell_count;
  const uint8_t* ghosts; /* for each cell: not 0 if another rank owns it; NULL if there are none */
  const gs_insitu_field* fields;
  size_t field_count;
} gs_insitu_cells;

/* Particles that this rank holds. */
typedef struct gs_insitu_particles {
  size_t size;           /* sizeof(gs_insitu_particles) */
  const void* positions; /* x, y, z of each particle */
  int32_t position_type; /* GS_INSITU_FLOAT32 or GS_INSITU_FLOAT64 */
  int32_t reserved;
  size_t count;
  double radius; /* of each particle, in units of the positions; 0 means a radius that suits their density */
  const gs_insitu_field* fields;
  size_t field_count;
} gs_insitu_particles;

/* Communication of the caller's ranks. ghostspace/insitu_mpi.h fills the table from an MPI_Comm. Each function blocks,
 * and returns 0 on success. Only collective functions call them. */
typedef struct gs_insitu_communicator {
  size_t size; /* sizeof(gs_insitu_communicator) */
  int32_t rank, ranks;
  void* context; /* first argument of the functions */
  int (*broadcast)(void* context, void* data, size_t bytes, int root);
  int (*gather)(void* context, const void* data, size_t bytes, void* all,
                int root); /* `bytes` of each rank, in order */
  int (*barrier)(void* context);
  int (*send)(void* context, const void* data, size_t bytes, int to, int tag);
  int (*receive)(void* context, void* data, size_t bytes, int from, int tag);
} gs_insitu_communicator;

/* Value of max_share that leaves the choice of the share to the library (default). */
#define GS_INSITU_USUAL_SHARE (-1.0)

/* Options of a session. gs_insitu_options_init() sets the defaults. All ranks pass equal options. */
typedef struct gs_insitu_options {
  size_t size;            /* sizeof(gs_insitu_options) */
  const char* title;      /* shown by viewers; NULL: "simulation" */
  const char* folder;     /* writes NAME.NNNNNN.qnv for each taken step, with NAME of the field; NULL writes nothing */
  int32_t serve;          /* 1: rank 0 serves the newest step over HTTP, on a thread of its own */
  int32_t port;           /* of the server; 0 means any free port */
  const char* bind;       /* address of the server; NULL: "127.0.0.1" */
  const char* token_file; /* file (mode 0600) for the token that changes parameters; NULL: a file of the user, see
                             docs/insitu.md */
  const char* field;      /* field to serve until a viewer chooses one; NULL: the first field */
  double error;           /* maximum error of each value, in its unit; 0 means that `relative_error` applies */
  double relative_error;  /* maximum error as a share of the range of the step's values; default 0.001 */
  double max_share;       /* maximum share of run time that the library may take, e.g. 0.05; 0 means unlimited.
                             Default GS_INSITU_USUAL_SHARE: with serve and without folder, 0.02 for grids of more than
                             65,536 points, and 0.1 for other data; otherwise unlimited */
  int64_t every;          /* takes at most each n-th step; default 1 */
  uint64_t max_memory; /* bytes for data of a step on each rank; a larger grid is thinned by 2, 4, ... per axis, larger
                          sets of particles by any number; default 256 MiB */
  int32_t threads;     /* maximum number of threads for encoding; default 1 */
  int32_t background;  /* 1: rank 0 may encode on a thread of its own while the simulation continues */
  int32_t thin;        /* 1: thins grids so that max_share permits each wanted step; 0: full grids, fewer steps */
  int32_t reserved;
  void (*log)(void* context, const char* message); /* receives messages on the calling thread; NULL: none */
  void* log_context;
  const char* live_file; /* with serve: file (mode 0600) with the address of the server, for ssh:// URLs, such as
                            "run.live"; NULL: none. Since version 2 */
} gs_insitu_options;

/* Parameter that viewers may change. */
typedef struct gs_insitu_parameter {
  size_t size;       /* sizeof(gs_insitu_parameter) */
  const char* name;  /* letters, digits and '_' */
  const char* label; /* for people; NULL: the name */
  const char* unit;  /* or NULL */
  double minimum, maximum, value;
  int32_t integer; /* 1: whole numbers only */
  int32_t reserved;
} gs_insitu_parameter;

/* Statistics of a session so far. Members marked "rank 0" are 0 on other ranks. */
typedef struct gs_insitu_statistics {
  size_t size;                    /* sizeof(gs_insitu_statistics), set by the caller */
  uint64_t steps, taken, skipped; /* numbers of begun steps, of taken steps, and of the other begun steps */
  double run_seconds;             /* wall time since gs_insitu_open() */
  double own_seconds;             /* processor time of the library on this rank, on all of its threads, plus the time in
                                     which it waited for other ranks and for files */
  double last_seconds;            /* from the end of the last taken step to its complete stream (rank 0) */
  uint64_t stream_bytes;          /* bytes of all streams (rank 0) */
  uint64_t sent_bytes;            /* bytes that this rank sent to others */
  uint64_t peak_bytes;            /* maximum size of the library's buffers without those of the encoder (estimate) */
  double max_error;  /* maximum error of the last taken step as its streams state it, in the unit of values (rank 0) */
  uint32_t thinning; /* the last taken step has every n-th point per axis; 1 means all (rank 0) */
  uint32_t reserved;
  double processor_seconds; /* processor time of the library on this rank, on all of its threads. Since version 3 */
} gs_insitu_statistics;

typedef struct gs_insitu gs_insitu;

/* Returns GS_INSITU_VERSION of the library. */
GS_INSITU_API uint32_t gs_insitu_version(void);

/* Sets the defaults. `size` is sizeof(gs_insitu_options). */
GS_INSITU_API void gs_insitu_options_init(gs_insitu_options* options, size_t size);

/* Begins a session. Collective. `communicator` may be NULL for one process; its functions must stay valid. If any rank
 * fails, returns NULL on all ranks and writes a message of at most `error_size` bytes to `error` (if not NULL). */
GS_INSITU_API gs_insitu* gs_insitu_open(const gs_insitu_options* options, const gs_insitu_communicator* communicator,
                                        char* error, size_t error_size);

/* Adds a parameter. Call it on all ranks before the first step. Returns a gs_insitu_result. */
GS_INSITU_API int gs_insitu_add_parameter(gs_insitu* session, const gs_insitu_parameter* parameter);

/* Returns the value of a parameter: equal on all ranks, and constant between two calls of gs_insitu_begin_step(). NaN
 * for unknown names. */
GS_INSITU_API double gs_insitu_value(const gs_insitu* session, const char* name);

/* Begins a step. Collective. Returns GS_INSITU_OK if the caller should pass its arrays and call gs_insitu_end_step().
 * Returns GS_INSITU_SKIPPED if the caller should do neither. Most skipped steps cost well under a microsecond. Returns
 * a value below 0 on errors. */
GS_INSITU_API int gs_insitu_begin_step(gs_insitu* session, int64_t step, double time);

/* Pass arrays of the step. The library copies the structure. The arrays must stay valid and unchanged until
 * gs_insitu_end_step() returns. */
GS_INSITU_API int gs_insitu_pass_block(gs_insitu* session, const gs_insitu_block* block);
GS_INSITU_API int gs_insitu_pass_cells(gs_insitu* session, const gs_insitu_cells* cells);
GS_INSITU_API int gs_insitu_pass_particles(gs_insitu* session, const gs_insitu_particles* particles);

/* Ends a step: sends the data to rank 0, which encodes it. Collective. Afterwards the caller may change its arrays.
 */
GS_INSITU_API int gs_insitu_end_step(gs_insitu* session);

/* Returns the port of the server on rank 0, or 0. */
GS_INSITU_API int gs_insitu_port(const gs_insitu* session);

/* Returns the message of the last error of this handle; "" if there was none. Valid until the next call. */
GS_INSITU_API const char* gs_insitu_error(const gs_insitu* session);

/* Fills the statistics. `statistics->size` must be set. */
GS_INSITU_API int gs_insitu_get_statistics(const gs_insitu* session, gs_insitu_statistics* statistics);

/* Waits until the streams of all taken steps are complete. Local. */
GS_INSITU_API int gs_insitu_flush(gs_insitu* session);

/* Ends the session, its server and its threads. NULL has no effect. Collective. */
GS_INSITU_API void gs_insitu_close(gs_insitu* session);

#ifdef __cplusplus
}
#endif

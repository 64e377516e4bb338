/* Fills a gs_insitu_communicator from an MPI_Comm. Header only: libghostspace-insitu works with any MPI. C99
 * and C++. */
#pragma once

#include <ghostspace/insitu.h>
#include <mpi.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Communicator and its table. Must stay valid, at the same address, until gs_insitu_close(). */
typedef struct gs_insitu_mpi {
  MPI_Comm comm; /* a duplicate of the caller's */
  gs_insitu_communicator table;
} gs_insitu_mpi;

/* Maximum bytes of one message. Counts of MPI 3 are int, so longer messages are sent in pieces. */
enum { GS_INSITU_MPI_PIECE = 1 << 30 };

static inline int gs_insitu_mpi_broadcast(void* context, void* data, size_t bytes, int root) {
  char* at = (char*)data;
  while (bytes > 0) {
    const int count = bytes < GS_INSITU_MPI_PIECE ? (int)bytes : GS_INSITU_MPI_PIECE;
    if (MPI_Bcast(at, count, MPI_BYTE, root, ((gs_insitu_mpi*)context)->comm) != MPI_SUCCESS) return 1;
    at += count;
    bytes -= (size_t)count;
  }
  return 0;
}

static inline int gs_insitu_mpi_gather(void* context, const void* data, size_t bytes, void* all, int root) {
  if (bytes > GS_INSITU_MPI_PIECE) return 1;
  return MPI_Gather((void*)data, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, root,
                    ((gs_insitu_mpi*)context)->comm) != MPI_SUCCESS;
}

static inline int gs_insitu_mpi_barrier(void* context) {
  return MPI_Barrier(((gs_insitu_mpi*)context)->comm) != MPI_SUCCESS;
}

static inline int gs_insitu_mpi_send(void* context, const void* data, size_t bytes, int to, int tag) {
  const char* at = (const char*)data;
  while (bytes > 0) {
    const int count = bytes < GS_INSITU_MPI_PIECE ? (int)bytes : GS_INSITU_MPI_PIECE;
    if (MPI_Send((void*)at, count, MPI_BYTE, to, tag, ((gs_insitu_mpi*)context)->comm) != MPI_SUCCESS) return 1;
    at += count;
    bytes -= (size_t)count;
  }
  return 0;
}

static inline int gs_insitu_mpi_receive(void* context, void* data, size_t bytes, int from, int tag) {
  char* at = (char*)data;
  while (bytes > 0) {
    const int count = bytes < GS_INSITU_MPI_PIECE ? (int)bytes : GS_INSITU_MPI_PIECE;
    if (MPI_Recv(at, count, MPI_BYTE, from, tag, ((gs_insitu_mpi*)context)->comm, MPI_STATUS_IGNORE) != MPI_SUCCESS)
      return 1;
    at += count;
    bytes -= (size_t)count;
  }
  return 0;
}

/* Duplicates `comm` and fills the table. Collective. Returns NULL on failure. gs_insitu_mpi_close() releases the
 * result. */
static inline gs_insitu_mpi* gs_insitu_mpi_open(MPI_Comm comm) {
  int rank = 0, ranks = 1;
  gs_insitu_mpi* made = (gs_insitu_mpi*)calloc(1, sizeof *made);
  if (!made) return NULL;
  if (MPI_Comm_dup(comm, &made->comm) != MPI_SUCCESS) {
    free(made);
    return NULL;
  }
  MPI_Comm_rank(made->comm, &rank);
  MPI_Comm_size(made->comm, &ranks);
  made->table.size = sizeof made->table;
  made->table.rank = rank;
  made->table.ranks = ranks;
  made->table.context = made;
  made->table.broadcast = gs_insitu_mpi_broadcast;
  made->table.gather = gs_insitu_mpi_gather;
  made->table.barrier = gs_insitu_mpi_barrier;
  made->table.send = gs_insitu_mpi_send;
  made->table.receive = gs_insitu_mpi_receive;
  return made;
}

/* Releases the duplicate. Call it after gs_insitu_close() and before MPI_Finalize(). NULL has no effect. */
static inline void gs_insitu_mpi_close(gs_insitu_mpi* mpi) {
  if (!mpi) return;
  MPI_Comm_free(&mpi->comm);
  free(mpi);
}

#ifdef __cplusplus
}
#endif

#pragma once

#include "net/base/shared_library.h"

#include <microhttpd.h>

#include <string>

/// Functions of libmicrohttpd that the program calls.
#define GHOSTSPACE_MICROHTTPD_FUNCTIONS(X) \
  X(MHD_add_connection)                    \
  X(MHD_add_response_header)               \
  X(MHD_create_response_from_buffer)       \
  X(MHD_create_response_from_callback)     \
  X(MHD_destroy_response)                  \
  X(MHD_get_connection_info)               \
  X(MHD_get_connection_values)             \
  X(MHD_get_daemon_info)                   \
  X(MHD_get_timeout)                       \
  X(MHD_get_version)                       \
  X(MHD_lookup_connection_value)           \
  X(MHD_queue_response)                    \
  X(MHD_quiesce_daemon)                    \
  X(MHD_resume_connection)                 \
  X(MHD_run)                               \
  X(MHD_start_daemon)                      \
  X(MHD_stop_daemon)                       \
  X(MHD_suspend_connection)

namespace gs::net {

/// Functions of libmicrohttpd, loaded at first use.
struct MicrohttpdLibrary {
  MicrohttpdLibrary();

  std::string problem;  // empty on success; otherwise no function may be called
  GHOSTSPACE_MICROHTTPD_FUNCTIONS(GHOSTSPACE_LIBRARY_MEMBER)
};
/// Returns the library. Any thread.
[[nodiscard]] const MicrohttpdLibrary& microhttpd();

}  // namespace gs::net

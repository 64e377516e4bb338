#pragma once

#include "app/insitu/include/ghostspace/insitu.h"

#include <cstdint>
#include <functional>
#include <string>
#include <variant>

namespace gs::app::insitu {

/// Default shares of run time: for grids that ranks keep for requests, and for other data. Other data are encoded at
/// once, so their first picture costs more.
inline constexpr double kShareOfKept = 0.02, kShareOfEncoded = 0.1;

/// Options of a session, as C++ values.
struct SessionOptions {
  std::string title = "simulation", folder, bind = "127.0.0.1", token_file, live_file, field;
  bool serve = false, background = false, thin = false;
  std::uint16_t port = 0;
  double error = 0, relative_error = 0.001, max_share = 0;
  bool usual_share = false;  // true if the library chooses the share (GS_INSITU_USUAL_SHARE)
  std::int64_t every = 1;
  std::uint64_t max_memory = std::uint64_t{256} << 20;
  unsigned threads = 1;
  std::function<void(const std::string& message)> log;
  std::function<void(const char* part)> fault;  // for tests: Ranks::set_fault()
};
/// Reads the options of a caller. Returns the problem if they are invalid.
[[nodiscard]] std::variant<SessionOptions, std::string> session_options(const gs_insitu_options& options);

}  // namespace gs::app::insitu

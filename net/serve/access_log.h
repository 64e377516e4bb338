#pragma once

#include "net/base/descriptor.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace gs::net {

/// Served request with its result, for the log.
struct AccessRecord {
  std::string client, method, target,
      version;  // as received; `target` and `method` may contain any bytes
  std::int64_t time = 0;  // time of the request, Unix seconds
  int status = 0;
  std::uint64_t bytes = 0;  // bytes of the body that were passed to the system
  double seconds = 0;
};
/// Returns a line in Common Log Format and the duration in seconds. Writes quotes, backslashes and non-printing bytes
/// as \xNN, so that a request cannot forge a line.
[[nodiscard]] std::string log_line(const AccessRecord& record);

/// Access log. Appends to a file or writes to standard output. One thread.
class AccessLog {
 public:
  AccessLog() = default;
  /// Opens a log at `path`. "-" means standard output. Returns an error on failure.
  [[nodiscard]] static std::variant<AccessLog, std::string> open(const std::string& path);
  void write(std::string_view line) const;

 private:
  Descriptor file_;
};

}  // namespace gs::net

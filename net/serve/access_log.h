#pragma once

#include "net/base/descriptor.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace gs::net {

/// One request, and what became of it.
struct AccessRecord {
  std::string client, method, target,
      version;            // target and method as they came: any bytes
  std::int64_t time = 0;  // Unix seconds, when it came
  int status = 0;
  std::uint64_t bytes = 0;  // of the body, handed to the system
  double seconds = 0;
};
/// A line of the Common Log Format with the duration in seconds behind it.
/// Quotes, backslashes and whatever does not print are written as \xNN, so that
/// no request can forge a line.
[[nodiscard]] std::string log_line(const AccessRecord& record);

/// Where lines go: a file that grows, or standard output. One thread.
class AccessLog {
 public:
  /// No log.
  AccessLog() = default;
  /// "-": standard output.
  [[nodiscard]] static std::variant<AccessLog, std::string> open(const std::string& path);
  void write(std::string_view line) const;

 private:
  Descriptor file_;
};

}  // namespace gs::net

#include "net/serve/access_log.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <unistd.h>

namespace gs::net {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 2048)) {
    const auto code = static_cast<unsigned char>(c);
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(code));
    if (code < 0x20 || code > 0x7e || c == '"' || c == '\\') {
      out += escape;
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string log_line(const AccessRecord& record) {
  static constexpr const char* kMonths[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                            "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto time = static_cast<std::time_t>(record.time);
  std::tm parts{};
  gmtime_r(&time, &parts);
  char date[64], rest[96];
  std::snprintf(date, sizeof date, "[%02d/%s/%04d:%02d:%02d:%02d +0000]", parts.tm_mday, kMonths[parts.tm_mon % 12],
                parts.tm_year + 1900, parts.tm_hour, parts.tm_min, parts.tm_sec);
  std::snprintf(rest, sizeof rest, "%d %llu %.3f\n", record.status, static_cast<unsigned long long>(record.bytes),
                record.seconds);
  return record.client + " - - " + date + " \"" + escaped(record.method) + " " + escaped(record.target) + " " +
         escaped(record.version) + "\" " + rest;
}

std::variant<AccessLog, std::string> AccessLog::open(const std::string& path) {
  AccessLog log;
  log.file_ =
      Descriptor(path == "-" ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)
                             : ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY, 0644));
  if (!log.file_) return path + ": cannot be opened for the log: " + std::strerror(errno);
  return log;
}

void AccessLog::write(std::string_view line) const {
  // If a line cannot be written, drop the line; the server must continue.
  while (file_ && !line.empty()) {
    const ssize_t written = ::write(file_.get(), line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    line.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace gs::net

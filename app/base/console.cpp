#include "app/base/console.h"

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace gs::app {
namespace {

constexpr char kClearLine[] = "\r\033[K";
std::atomic<bool> progress_line{false};  // true if the terminal shows a progress line

int output_error = 0;  // errno of the first write to standard output that failed; 0 means none

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 0;  // length in UTF-8; 0 means that the bytes are not UTF-8
};

// Decodes the first code point of a text that is not empty. Rejects overlong forms, surrogates, and values above
// U+10FFFF (RFC 3629).
CodePoint first_code_point(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = at(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || bytes > text.size()) return {};
  std::uint32_t value = lead & (0xffU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((at(i) & 0xc0U) != 0x80) return {};
    value = value << 6U | (at(i) & 0x3fU);
  }
  static constexpr std::uint32_t kMin[] = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kMin[bytes] || value > 0x10ffff || (value >= 0xd800 && value < 0xe000)) return {};
  return {value, bytes};
}

// Returns true for control characters of a terminal, and for characters that reorder the text after them.
bool controls(std::uint32_t c) {
  if (c < 0x20 || (c >= 0x7f && c < 0xa0)) return true;
  return c == 0x061c || c == 0x200e || c == 0x200f || (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

std::string escape_of(const CodePoint& c, unsigned char byte) {
  char text[16];
  if (c.bytes == 1 && (c.value == '\n' || c.value == '\t' || c.value == '\r'))
    return c.value == '\n' ? "\\n" : c.value == '\t' ? "\\t" : "\\r";
  if (c.bytes > 1)
    std::snprintf(text, sizeof text, "\\u%04x", static_cast<unsigned>(c.value));
  else
    std::snprintf(text, sizeof text, "\\x%02x", static_cast<unsigned>(byte));
  return text;
}

// Returns `text` with escaped control characters. `lines` preserves line ends and tabs.
std::string without_controls(std::string_view text, bool lines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const CodePoint c = first_code_point(text);
    const std::size_t bytes = c.bytes == 0 ? 1 : c.bytes;
    if (c.bytes == 0 || (controls(c.value) && !(lines && (c.value == '\n' || c.value == '\t'))))
      out += escape_of(c, static_cast<unsigned char>(text.front()));
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

std::string formatted(const char* format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, arguments);
  std::vector<char> text(size > 0 ? static_cast<std::size_t>(size) + 1 : 1);
  (void)std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  return {text.data(), text.size() - 1};
}

void write_output(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() && output_error == 0)
    output_error = errno != 0 ? errno : EIO;
}

}  // namespace

std::string printable(std::string_view text) { return without_controls(text, false); }

void print_line(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const std::string text = formatted(format, arguments);
  va_end(arguments);
  write_output(printable(text) + "\n");
}

void print_text(std::string_view text) {
  if (::isatty(STDOUT_FILENO) == 1)
    write_output(without_controls(text, true));
  else
    write_output(text);
}

bool output_failed() { return output_error != 0; }

void complain(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const std::string text = formatted(format, arguments);
  va_end(arguments);
  const std::string line = (progress_line.exchange(false) ? kClearLine : "") + printable(text) + "\n";
  (void)std::fwrite(line.data(), 1, line.size(), stderr);
}

bool progress_shows() {
  static const bool terminal = ::isatty(STDERR_FILENO) == 1;
  return terminal;
}

void show_progress(std::string_view text) {
  if (!progress_shows()) return;
  progress_line = !text.empty();
  const std::string line = kClearLine + std::string(text);
  (void)std::fwrite(line.data(), 1, line.size(), stderr);
}

void prepare_console() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0 || errno != EBADF) continue;
    // open() returns the lowest free descriptor, here `number`. Writing to it fails, as it does for a closed output.
    (void)!::open("/dev/null", number == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
}

std::optional<std::string> finish_output() {
  errno = 0;
  if (std::fflush(stdout) != 0 && output_error == 0) output_error = errno != 0 ? errno : EIO;
  // Some file systems report a full disk only in close(). Close a copy, so that the original descriptor stays open.
  const int copy = ::dup(STDOUT_FILENO);
  if (copy >= 0 && ::close(copy) != 0 && output_error == 0) output_error = errno;
  if (output_error == 0) return std::nullopt;
  return "cannot write standard output: " + std::generic_category().message(output_error);
}

}  // namespace gs::app

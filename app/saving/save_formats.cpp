#include "app/saving/save_formats.h"

#include "app/base/temporary_file.h"
#include "app/formats/export/export.h"
#include "base/gzip.h"
#include "base/text.h"
#include "net/files/file.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

namespace gs::app {
namespace {

constexpr std::string_view kTextExtensions[] = {".wrl", ".vrml", ".wrz", ".wrl.gz"};
constexpr std::string_view kPackedExtensions[] = {".wrz", ".gz"};

template <std::size_t N>
bool ends_with_any(std::string_view path, const std::string_view (&extensions)[N]) {
  const std::string lower = lower_case(std::string(path));
  return std::any_of(std::begin(extensions), std::end(extensions),
                     [&](std::string_view extension) { return lower.ends_with(extension); });
}

}  // namespace

bool is_text_path(std::string_view path) { return ends_with_any(path, kTextExtensions); }

std::string save_format_list() {
  std::string text = ".wrl, .wrz (VRML97)";
  const char* separator = "; only the surface: ";
  for (const ExportFormat& format : export_formats()) {
    if (is_text_path(format.extension)) continue;
    text.append(std::exchange(separator, ", ")).append(format.extension);
  }
  return text;
}

std::string path_with_format(const std::string& path) {
  return is_text_path(path) || export_format_of(path) ? path : path + ".wrl";
}

std::optional<std::string> write_world_text(const std::string& path, std::string_view text) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  remove_unfinished_beside(path);
  const auto problem = ends_with_any(path, kPackedExtensions) ? net::write_file_atomically(path, gzip(bytes))
                                                              : net::write_file_atomically(path, bytes);
  return problem ? std::optional(problem->message) : std::nullopt;
}

}  // namespace gs::app

#include "app/saving/save_formats.h"

#include "app/base/temporary_file.h"
#include "app/formats/export/export.h"
#include "app/saving/scene_formats.h"
#include "base/gzip.h"
#include "base/text.h"
#include "net/files/file.h"

#include <span>
#include <utility>

namespace gs::app {

bool is_text_path(std::string_view path) { return scene_format_of(path) != nullptr; }

bool is_stream_path(std::string_view path) { return lower_case(path).ends_with(".qnv"); }

std::string save_format_list() {
  std::string text = scene_format_list();
  const char* separator = "; only the data: ";
  for (const ExportFormat& format : export_formats()) {
    if (is_text_path(format.extension)) continue;
    text.append(std::exchange(separator, ", ")).append(format.extension);
  }
  return text + ", .qnv";
}

std::string path_with_format(const std::string& path) {
  return is_text_path(path) || is_stream_path(path) || export_format_of(path) ? path : path + ".wrl";
}

std::optional<std::string> write_world_text(const std::string& path, std::string_view text) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  remove_unfinished_beside(path);
  const auto problem =
      is_packed_path(path) ? net::write_file_atomically(path, gzip(bytes)) : net::write_file_atomically(path, bytes);
  return problem ? std::optional(problem->message) : std::nullopt;
}

}  // namespace gs::app

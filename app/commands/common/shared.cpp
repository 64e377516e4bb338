#include "app/commands/common/shared.h"

#include "app/base/console.h"
#include "app/commands/common/option_groups.h"
#include "app/formats/content_types.h"
#include "app/formats/export/export.h"
#include "base/diagnostic.h"
#include "base/json_value.h"
#include "base/text.h"
#include "net/files/file.h"

#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>

namespace gs::app {

void print_diagnostics(const Diagnostics& diagnostics) {
  for (const CountedDiagnostic& one : joined(diagnostics.entries())) complain("%s", text_of(one).c_str());
  if (diagnostics.dropped() > 0) complain("ghostspace: %zu more diagnostics are not shown", diagnostics.dropped());
}

int write_stats(const std::string& path, const std::string& json) {
  if (path == "-") {
    print_text(json);
    return kDone;
  }
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    const auto opened = net::map_file(path);
    const auto* file = std::get_if<net::MappedFile>(&opened);
    const bool ours = file && is_json_with({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()},
                                           "peak_rss_bytes");
    if (!ours && !(file && file->bytes().empty())) {
      complain("%s: error: already exists and has no measurements; not overwritten", path.c_str());
      return kFailed;
    }
  }
  const auto problem = net::write_file_atomically(path, std::as_bytes(std::span(json)));
  if (problem) complain("%s: error: %s", path.c_str(), problem->message.c_str());
  return problem ? kNotWritten : kDone;
}

int fail(const std::string& what) {
  complain("ghostspace: error: %s", what.c_str());
  return kFailed;
}

int fail_to_write(const std::string& what) {
  (void)fail(what);
  return kNotWritten;
}

std::optional<std::string> refuse_to_replace(const std::string& out, const std::string& in,
                                             std::span<const std::byte> bytes) {
  std::error_code error;
  if (!std::filesystem::exists(out, error)) return std::nullopt;
  if (std::filesystem::equivalent(out, in, error)) return out + " is also the input; not overwritten";
  const auto opened = net::map_file(out);
  if (const auto* problem = std::get_if<net::FileError>(&opened)) return problem->message;
  const std::span<const std::byte> old = std::get<net::MappedFile>(opened).bytes();
  if (old.empty()) return std::nullopt;
  const ContentType* type = content_type_by_mark(first_bytes(bytes));
  // Files without a type, such as images and materials, are of one kind if they begin alike.
  constexpr std::size_t kMark = 8;
  if (!type && bytes.size() >= kMark && old.size() >= kMark && text_of(bytes.first(kMark)) == text_of(old.first(kMark)))
    return std::nullopt;
  if (type && content_type_by_mark(first_bytes(old)) == type) return std::nullopt;
  return out + " already exists and is not " + (type ? std::string(type->name) : "a file of this format") +
         "; not overwritten";
}

std::string export_format_list() {
  std::string text;
  for (const ExportFormat& format : export_formats())
    text += (text.empty() ? "" : ", ") + std::string(format.extension) + " (" + std::string(format.description) + ")";
  return text;
}

LoadOptions load_options(const LoadingOptions& options) {
  LoadOptions load = options;
  load.cache_folder = http_cache_folder();
  load.allowed.insert(load.allowed.end(), options.files.begin(), options.files.end());
  return load;
}

std::string http_cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache && cache[0] == '/') return std::string(cache) + "/ghostspace/http";
  const char* home = std::getenv("HOME");
  return home && home[0] == '/' ? std::string(home) + "/.cache/ghostspace/http" : std::string();
}

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

std::string demo_world() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path() / "../share/ghostspace/worlds/demo.wrl";
  return !error && fs::exists(installed, error) ? installed.lexically_normal().string()
                                                : GHOSTSPACE_SOURCE_ASSETS "/worlds/demo.wrl";
}

}  // namespace gs::app

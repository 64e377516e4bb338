#include "app/commands/commands.h"
#include "net/file.h"

#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>

namespace gs::app {

void print_diagnostics(const vrml::Diagnostics& diagnostics) {
  for (const vrml::Diagnostic& diagnostic : diagnostics.entries())
    std::fprintf(stderr, "%s\n", diagnostic.text().c_str());
  if (diagnostics.dropped() > 0)
    std::fprintf(stderr, "ghostspace: %zu more diagnostics are not shown\n", diagnostics.dropped());
}

bool write_stats(const std::string& path, const std::string& json) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    const auto opened = net::map_file(path);
    const auto* file = std::get_if<net::MappedFile>(&opened);
    const auto old =
        file ? nlohmann::json::parse(reinterpret_cast<const char*>(file->bytes().data()),
                                     reinterpret_cast<const char*>(file->bytes().data()) + file->bytes().size(),
                                     nullptr, false)
             : nlohmann::json();
    const bool ours = old.is_object() && old.contains("peak_rss_bytes");
    if (!ours && !(file && file->bytes().empty())) {
      std::fprintf(stderr, "%s: error: is there and holds no measurements; it is not written over\n", path.c_str());
      return false;
    }
  }
  const auto problem = net::write_file_atomically(path, std::as_bytes(std::span(json)));
  if (problem) std::fprintf(stderr, "%s: error: %s\n", path.c_str(), problem->message.c_str());
  return !problem;
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

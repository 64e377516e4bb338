#include "app/base/environment.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

namespace gs::app {
namespace {

constexpr std::string_view kNames[] = {
    "PATH",
    "LANG",
    "LANGUAGE",
    "TZ",
    "TMPDIR",
    "LD_LIBRARY_PATH",
    "FONTCONFIG_FILE",
    "FONTCONFIG_PATH",
    "ASAN_OPTIONS",
    "LSAN_OPTIONS",
    "TSAN_OPTIONS",
    "UBSAN_OPTIONS",
};
constexpr std::string_view kPrefixes[] = {"LC_", "MESA_", "LIBGL_", "GALLIUM_", "LP_", "EGL_", "__EGL_"};

std::string_view name_of(const char* entry) {
  const std::string_view text(entry);
  return text.substr(0, text.find('='));
}

}  // namespace

bool is_kept_variable(std::string_view name) {
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames) ||
         std::any_of(std::begin(kPrefixes), std::end(kPrefixes),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

std::vector<char*> kept_environment() {
  std::vector<char*> kept;
  for (char** entry = environ; entry && *entry; ++entry)
    if (is_kept_variable(name_of(*entry))) kept.push_back(*entry);
  kept.push_back(nullptr);
  return kept;
}

void spare_full_disk() {
  namespace fs = std::filesystem;
  constexpr std::uintmax_t kLeastRoom = std::uintmax_t{64} << 20;
  constexpr const char* kDisabled = "MESA_SHADER_CACHE_DISABLE";
  const auto value_of = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (!value_of(kDisabled).empty()) return;
  fs::path folder = value_of("MESA_SHADER_CACHE_DIR");
  if (folder.empty()) folder = value_of("XDG_CACHE_HOME");
  if (folder.empty() && !value_of("HOME").empty()) folder = fs::path(value_of("HOME")) / ".cache";
  std::error_code error;
  while (!folder.empty() && !fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  if (folder.empty()) return;
  const fs::space_info room = fs::space(folder, error);
  if (!error && room.available < kLeastRoom) (void)::setenv(kDisabled, "true", 1);
}

void clear_environment() {
  char** to = environ;
  if (!to) return;
  for (char** entry = environ; *entry; ++entry) {
    if (is_kept_variable(name_of(*entry)))
      *to++ = *entry;
    else
      ::explicit_bzero(*entry, std::strlen(*entry));
  }
  *to = nullptr;
}

}  // namespace gs::app

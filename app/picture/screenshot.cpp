#include "app/picture/screenshot.h"

#include "net/files/file.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <variant>

namespace gs::app {

std::string pictures_folder(const std::function<std::string(const char*)>& variable,
                            std::string_view user_directories) {
  if (std::string own = variable("XDG_PICTURES_DIR"); own.starts_with('/')) return own;
  const std::string home = variable("HOME");
  if (!home.starts_with('/')) return {};
  // Match lines such as XDG_PICTURES_DIR="$HOME/Bilder" (xdg-user-dirs).
  constexpr std::string_view kName = "XDG_PICTURES_DIR=\"", kHome = "$HOME";
  const std::size_t name = user_directories.find(kName);
  const bool starts = name == 0 || (name != std::string_view::npos && user_directories[name - 1] == '\n');
  if (starts) {
    std::string_view value = user_directories.substr(name + kName.size());
    value = value.substr(0, value.find_first_of("\"\n"));
    if (value.starts_with(kHome)) return home + std::string(value.substr(kHome.size()));
    if (value.starts_with('/')) return std::string(value);
  }
  return home + "/Pictures";
}

std::string pictures_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  std::string config = variable("XDG_CONFIG_HOME");
  if (!config.starts_with('/')) config = variable("HOME") + "/.config";
  const auto opened = net::map_file(config + "/user-dirs.dirs");
  const auto* file = std::get_if<net::MappedFile>(&opened);
  constexpr std::size_t kMax = 65536;
  if (!file || file->bytes().size() > kMax) return pictures_folder(variable, {});
  return pictures_folder(variable, {reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()});
}

std::string picture_name(std::string_view title, double time, std::string_view extension) {
  constexpr std::size_t kMaxTitle = 80;  // max bytes of the title in a file name
  std::string name;
  for (const char c : title) {
    const auto byte = static_cast<unsigned char>(c);
    name += byte < ' ' || byte == 127 || std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos ? '_' : c;
  }
  if (name.size() > kMaxTitle) {
    std::size_t end = kMaxTitle;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
    name.resize(end);
  }
  while (name.starts_with('.') || name.starts_with(' ')) name.erase(0, 1);
  if (name.empty()) name = "GhostSpace";
  const auto seconds = static_cast<std::time_t>(std::isfinite(time) ? time : 0);
  std::tm local{};
  std::array<char, 32> when{};
  if (localtime_r(&seconds, &local)) std::strftime(when.data(), when.size(), " %Y-%m-%d %H-%M-%S", &local);
  return name + when.data() + std::string(extension);
}

std::string free_path(const std::string& folder, const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  std::error_code error;
  std::filesystem::path tried = path;
  for (int i = 2; std::filesystem::exists(tried, error) && i < 10000; ++i)
    tried = path.parent_path() / (path.stem().string() + " (" + std::to_string(i) + ")" + path.extension().string());
  return tried.string();
}

}  // namespace gs::app

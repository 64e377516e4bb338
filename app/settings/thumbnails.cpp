#include "app/settings/thumbnails.h"

#include "app/settings/user_folders.h"
#include "base/text.h"
#include "net/files/file.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kThumbnailSuffix = ".png";
constexpr std::size_t kMaxThumbnail = std::size_t{1} << 20;  // of a file

/// Returns a file name for a path or URL: its hash. If two have equal hashes, one shows the other's picture.
std::string name_of(std::string_view place) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(stable_hash(place)));
  return text + std::string(kThumbnailSuffix);
}

}  // namespace

std::string Thumbnails::file_of(const std::string& place) const { return folder_ + '/' + name_of(place); }

std::shared_ptr<const render::Image> Thumbnails::find(const std::string& place) {
  const auto [known, fresh] = images_.try_emplace(place);
  if (!fresh || folder_.empty()) return known->second;
  const auto opened = net::map_file(file_of(place));
  const auto* file = std::get_if<net::MappedFile>(&opened);
  if (!file || file->bytes().size() > kMaxThumbnail) return nullptr;
  render::ImageLimits limits;
  limits.file_pixels = limits.kept_pixels = std::size_t{4} * kWidth * kHeight;
  auto image = render::decode_image(file->bytes(), limits);
  if (auto* picture = std::get_if<render::Image>(&image))
    known->second = std::make_shared<const render::Image>(std::move(*picture));
  return known->second;
}

void Thumbnails::keep(const std::string& place, const std::vector<std::byte>& png) {
  if (folder_.empty()) return;
  images_.erase(place);
  (void)write_user_file(file_of(place), {reinterpret_cast<const char*>(png.data()), png.size()});
}

void Thumbnails::keep_only(const std::vector<std::string>& places) {
  if (folder_.empty()) return;
  std::set<std::string> names;
  for (const std::string& place : places) names.insert(name_of(place));
  std::error_code error;
  for (fs::directory_iterator file(folder_, error), end; !error && file != end; file.increment(error)) {
    std::error_code ignored;
    if (file->path().extension() == kThumbnailSuffix && !names.contains(file->path().filename()))
      fs::remove(file->path(), ignored);
  }
}

}  // namespace gs::app

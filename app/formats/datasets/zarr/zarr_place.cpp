#include "app/formats/datasets/zarr/zarr_place.h"

#include "app/formats/archive/zip_archive.h"
#include "base/text.h"
#include "net/base/url.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>

namespace gs::app {
namespace {

/// Archive with its bytes.
struct HeldArchive {
  SharedBytes bytes;
  ZipArchive archive;
  std::string folder;  // of the container in the archive, empty or with '/' at its end
};

// Files through which a container is opened, in the order of the attempts. Attributes come last, because those of an
// array may be any JSON object, which does not identify the format.
constexpr std::string_view kZarrEntryFiles[] = {"zarr.json", ".zmetadata", ".zgroup",
                                                ".zarray",   ".zattrs",    "attributes.json"};

bool is_zarr_metadata_file(std::string_view name) {
  return std::ranges::find(kZarrMetadataFiles, name) != std::end(kZarrMetadataFiles);
}

/// Returns the path that a reference of net::reference_of_path() stands for.
std::string zarr_path_of(const std::string& reference) {
  const std::string path = net::path_of_url(net::resolve(net::parse_url("file:///"), net::parse_url(reference)));
  return path.empty() ? path : path.substr(1);
}

std::string_view last_zarr_part(std::string_view path) { return path.substr(path.rfind('/') + 1); }

}  // namespace

bool is_zarr(std::span<const std::byte> bytes) {
  if (is_zip(bytes)) {
    const std::string_view name = first_name_in_zip(bytes);
    return name.find(".zarr/") != std::string_view::npos || is_zarr_metadata_file(last_zarr_part(name));
  }
  constexpr std::size_t kLookedAt = 32768;
  const std::string_view text = text_of(bytes).substr(0, kLookedAt);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '{') return false;
  const auto has = [&](std::string_view name) { return text.find(name) != std::string_view::npos; };
  return has("\"zarr_format\"") || has("\"zarr_consolidated_format\"") ||
         (has("\"multiscales\"") && has("\"datasets\"")) || (has("\"blockSize\"") && has("\"dataType\"")) ||
         has("\"n5\"") || has("\"_ARRAY_DIMENSIONS\"");
}

std::variant<ZarrPlace, std::string> zarr_place_of_zip(SharedBytes bytes, const WorldBudget& budget) {
  auto opened = ZipArchive::open(bytes.bytes);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const auto held = std::make_shared<HeldArchive>(HeldArchive{bytes, std::move(std::get<ZipArchive>(opened)), {}});
  // The container is the folder of the shortest path to a metadata file.
  const std::vector<std::string> paths = held->archive.paths();
  const std::string* shortest = nullptr;
  for (const std::string& path : paths)
    if (is_zarr_metadata_file(last_zarr_part(path)) && (!shortest || path.size() < shortest->size())) shortest = &path;
  if (!shortest) return std::string("the ZIP archive has no metadata of Zarr or N5");
  held->folder = shortest->substr(0, shortest->size() - last_zarr_part(*shortest).size());
  ZarrPlace place;
  place.budget = budget;
  place.read = [held, budget](std::span<const FileRequest> requests) {
    std::vector<FileResult> results;
    for (const FileRequest& request : requests) {
      auto read = held->archive.read_path(held->folder + zarr_path_of(request.reference), budget);
      if (!read)
        results.emplace_back(NoFile());
      else if (auto* const problem = std::get_if<std::string>(&*read))
        results.emplace_back(std::move(*problem));
      else
        results.push_back(part_of(shared_bytes(std::move(std::get<std::vector<std::byte>>(*read))), request.part));
    }
    return results;
  };
  const auto names = std::make_shared<const std::vector<std::string>>(paths);
  place.list = [held, names](const std::string& reference) -> std::optional<std::vector<std::string>> {
    const std::string path = zarr_path_of(reference);
    const std::string folder = held->folder + (path.empty() ? std::string() : path + "/");
    std::set<std::string> found;
    for (auto at = std::ranges::lower_bound(*names, folder); at != names->end() && at->starts_with(folder); ++at)
      if (const std::size_t slash = at->find('/', folder.size()); slash != std::string::npos)
        found.insert(at->substr(folder.size(), slash - folder.size()));
    return std::vector<std::string>(found.begin(), found.end());
  };
  return place;
}

std::span<const std::string_view> zarr_entry_files() { return kZarrEntryFiles; }

std::string zarr_entry_of_folder(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {};
  for (const std::string_view name : kZarrEntryFiles)
    if (const auto file = std::filesystem::path(path) / name; std::filesystem::is_regular_file(file, error))
      return file.string();
  return {};
}

std::vector<std::string> zarr_entries_of_url(std::string_view url) {
  net::Url parsed = net::parse_url(url);
  std::string path = parsed.path;
  while (path.ends_with('/')) path.pop_back();
  bool container = false;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string part = lower_case(path.substr(begin, end - begin));
    container = container || part.ends_with(".zarr") || part.ends_with(".n5");
    begin = end + 1;
  }
  const std::string_view name = last_zarr_part(path);
  if (!container || is_zarr_metadata_file(name)) return {};
  std::vector<std::string> urls;
  for (const std::string_view file : kZarrEntryFiles) {
    if (file == ".zmetadata") continue;  // the reader requests it
    net::Url one = parsed;
    one.path = path + "/" + std::string(file);
    urls.push_back(one.text());
  }
  return urls;
}

std::string zarr_title_of(std::string_view path) {
  const std::string_view name = last_zarr_part(path);
  if (!is_zarr_metadata_file(name) || name.size() == path.size()) return std::string(name);
  return std::string(last_zarr_part(path.substr(0, path.size() - name.size() - 1)));
}

}  // namespace gs::app

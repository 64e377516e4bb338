#include "app/formats/volume/file_states.h"

#include "app/base/local_file.h"
#include "app/formats/datasets/vtk/vtk_datasets.h"
#include "app/formats/datasets/vtk/vtk_files.h"
#include "app/formats/datasets/zarr/zarr_place.h"
#include "app/formats/volume/volume_common.h"
#include "net/files/file.h"
#include "net/files/file_stamp.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <sys/stat.h>
#include <zlib.h>

namespace gs::app {
namespace {

std::string checksum_of_bytes(std::span<const std::byte> bytes) {
  const auto* const first = reinterpret_cast<const unsigned char*>(bytes.data());
  return std::to_string(bytes.empty() ? 0 : crc32_z(0, first, bytes.size()));
}

// Returns the size and modification time of a mapped file, or the checksum of bytes in memory, which are few.
std::string state_of(const SharedBytes& file) {
  struct stat status {};
  const int descriptor = file.file ? file.file->descriptor() : -1;
  if (descriptor < 0 || !net::read_status(descriptor, status)) return checksum_of_bytes(file.bytes);
  return std::to_string(status.st_size) + " " + std::to_string(status.st_mtim.tv_sec) + "." +
         std::to_string(status.st_mtim.tv_nsec);
}

// Returns the number of files below a folder, and a checksum of their names, sizes and times.
std::string state_of_folder(const std::string& folder) {
  constexpr std::size_t kMostFiles = 10'000'000;
  std::size_t count = 0;
  uLong sum = 0;
  for (const std::string& name : files_below(folder, kMostFiles)) {
    std::error_code error;
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    const auto size = std::filesystem::file_size(file, error);
    const auto time = std::filesystem::last_write_time(file, error).time_since_epoch().count();
    const std::string line = name + " " + std::to_string(size) + " " + std::to_string(time) + "\n";
    sum = crc32_z(sum, reinterpret_cast<const unsigned char*>(line.data()), line.size());
    ++count;
  }
  return std::to_string(count) + " files, " + std::to_string(sum);
}

// Opens a VTK file and the files that it names, to a depth of kMostDepth. Opens a named file only once, because files
// may name themselves.
void open_members(VtkFiles& files) {
  constexpr int kMostDepth = 4;
  std::set<std::string> known;
  std::vector<std::string> paths{""};
  for (int depth = 0; depth <= kMostDepth; ++depth) {
    std::vector<std::string> next;
    for (const std::string& path : paths) {
      const VtkOpenedResult opened = files.open(path);
      const auto* const file = std::get_if<std::shared_ptr<const VtkOpened>>(&opened);
      if (!file) continue;
      for (const VtkMember& member : (*file)->index.members)
        if (std::string named = VtkFiles::path_of(**file, member); known.insert(named).second)
          next.push_back(std::move(named));
    }
    paths = std::move(next);
  }
}

// Reports whether files_below() omits a file, such as the metadata of an array.
bool is_hidden_file(std::string_view reference) {
  return reference.substr(reference.rfind('/') + 1).starts_with('.');
}

std::string name_of_request(const FileRequest& request) {
  if (!request.part) return request.reference;
  return request.reference + " " + std::to_string(request.part->offset) + "+" + std::to_string(request.part->bytes);
}

}  // namespace

void FileStates::add(const std::string& reference, const SharedBytes& file) {
  std::string state = state_of(file);
  const std::lock_guard lock(mutex_);
  states_.insert_or_assign(reference, std::move(state));
}

void FileStates::add_folder_of(const std::string& path) {
  const std::lock_guard lock(mutex_);
  const std::string folder = std::filesystem::path(path).parent_path().string();
  folder_ = folder.empty() ? "." : folder;
}

void FileStates::add_members(const std::string& path, SharedBytes file, ReadFile read) {
  const std::lock_guard lock(mutex_);
  members_path_ = path;
  members_file_ = std::move(file);
  read_member_ = std::move(read);
}

std::string FileStates::text() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::string> all = states_;
  if (read_member_) {
    VolumeFile first{members_path_, file_name(members_path_), members_file_, [&](const std::string& reference) {
                       BytesResult result = read_member_(reference);
                       if (const auto* const file = std::get_if<SharedBytes>(&result))
                         all.insert_or_assign(reference, state_of(*file));
                       return result;
                     }};
    VtkFiles files(std::move(first));
    open_members(files);
  }
  std::string text;
  for (const auto& [reference, state] : all) text += "\n" + reference + " " + state;
  return folder_.empty() ? text : text + "\n" + state_of_folder(folder_);
}

void note_files(const std::string& path, const SharedBytes& file, VolumeOrigin& origin) {
  if (!origin.states) return;
  if (!origin.read_beside) origin.read_beside = reader_beside(path, {});
  if (is_vtk_datasets(file.bytes)) origin.states->add_members(path, file, origin.read_beside);
  origin.read_beside = [read = std::move(origin.read_beside), states = origin.states](const std::string& reference) {
    BytesResult result = read(reference);
    if (const auto* const bytes = std::get_if<SharedBytes>(&result)) states->add(reference, *bytes);
    return result;
  };
  const std::string name = path.substr(path.rfind('/') + 1);
  const bool container = std::ranges::find(zarr_entry_files(), name) != zarr_entry_files().end();
  if (container) {
    origin.states->add_folder_of(path);
    origin.states->add(name, file);
  }
  if (!origin.read_files) {
    origin.read_files = files_beside(path, {});
    origin.list_folder = lister_beside(path);
  }
  origin.read_files = [read = std::move(origin.read_files), states = origin.states,
                       container](std::span<const FileRequest> requests) {
    std::vector<FileResult> results = read(requests);
    for (std::size_t i = 0; i < std::min(results.size(), requests.size()); ++i)
      // For a container, add_folder_of() covers all files that are not hidden.
      if (const auto* const bytes = std::get_if<SharedBytes>(&results[i]);
          bytes && (!container || is_hidden_file(requests[i].reference)))
        states->add(name_of_request(requests[i]), *bytes);
    return results;
  };
}

}  // namespace gs::app

#include "app/formats/datasets/vtk/vtk_files.h"

#include "base/gzip.h"
#include "net/base/reference_policy.h"

#include <algorithm>
#include <span>
#include <utility>

namespace gs::app {

VtkOpenedResult VtkFiles::open(const std::string& path) {
  if (const auto known = kept_.find(path); known != kept_.end()) return known->second;
  if (const auto known = missing_.find(path); known != missing_.end()) return known->second;
  auto opened = std::make_shared<VtkOpened>();
  opened->path = path;
  BytesResult bytes = path.empty() ? BytesResult(file_.content) : load(path);
  if (auto* const problem = std::get_if<std::string>(&bytes)) return std::move(*problem);
  opened->bytes = std::get<SharedBytes>(std::move(bytes));
  opened->kind = vtk_class_of(opened->bytes.bytes);
  if (opened->kind == VtkFileClass::leaf) {
    auto read = read_vtk_xml(opened->bytes.bytes, {});
    if (auto* const problem = std::get_if<std::string>(&read)) return std::move(*problem);
    opened->header = std::get<VtkXmlHeader>(std::move(read));
  } else if (opened->kind == VtkFileClass::other) {
    return std::string("it is not a VTK file");
  } else if (opened->kind != VtkFileClass::legacy) {
    auto read = read_vtk_index(opened->bytes.bytes);
    if (auto* const problem = std::get_if<std::string>(&read)) return std::move(*problem);
    opened->index = std::get<VtkIndex>(std::move(read));
  }
  if (order_.size() >= kMostKept) {
    kept_.erase(order_.front());
    order_.erase(order_.begin());
  }
  kept_.emplace(path, opened);
  order_.push_back(path);
  return std::shared_ptr<const VtkOpened>(std::move(opened));
}

BytesResult VtkFiles::load(const std::string& path) const {
  if (path.find('\0') != std::string::npos) return std::string("the name is invalid; expected a file name");
  const std::string reference = net::reference_of_path(path);
  BytesResult loaded = std::string("other files are not read here");
  if (file_.read_files && (lazy_ || !file_.read_beside)) {
    const FileRequest request{reference, {}};
    std::vector<FileResult> results = file_.read_files(std::span(&request, 1));
    if (results.size() != 1) return loaded;
    if (auto* const bytes = std::get_if<SharedBytes>(&results[0])) loaded = std::move(*bytes);
    if (auto* const none = std::get_if<NoFile>(&results[0]))
      loaded = none->why.empty() ? std::string("there is no such file") : std::move(none->why);
    if (auto* const problem = std::get_if<std::string>(&results[0])) loaded = std::move(*problem);
  } else if (file_.read_beside) {
    loaded = file_.read_beside(reference);
  }
  if (const auto* const bytes = std::get_if<SharedBytes>(&loaded); bytes && is_gzip(bytes->bytes))
    return unpacked_gzip(bytes->bytes, file_.budget);
  return loaded;
}

std::string VtkFiles::path_of(const VtkOpened& file, const VtkMember& member) {
  std::string name = member.file;
  std::ranges::replace(name, '\\', '/');
  if (name.starts_with('/') || name.find("://") != std::string::npos) return name;
  const std::size_t slash = file.path.rfind('/');
  return slash == std::string::npos ? name : file.path.substr(0, slash + 1) + name;
}

void VtkFiles::note_missing(const std::string& path, const std::string& problem) {
  if (missing_.empty()) first_missing_ = path + ": " + problem;
  constexpr std::size_t kMostNoted = 100'000;
  if (missing_.size() < kMostNoted) missing_.emplace(path, problem);
}

std::string VtkFiles::missing() const {
  if (missing_.empty()) return {};
  const bool one = missing_.size() == 1;
  return std::to_string(missing_.size()) + (one ? " file is" : " files are") + " missing and left out" +
         (one ? ": " : "; the first is ") + first_missing_;
}

}  // namespace gs::app

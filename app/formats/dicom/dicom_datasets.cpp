#include "app/formats/dicom/dicom_datasets.h"

#include "app/formats/dicom/dicom_volume.h"
#include "base/text.h"
#include "net/base/reference_policy.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace gs::app {
namespace {

std::string type_name_of(const DicomImage& image) {
  if (image.pixels.color != DicomColor::gray) return "3 x u8";
  if (image.pixels.form == DicomSamples::f32) return "f32";
  if (image.pixels.form == DicomSamples::f64) return "f64";
  return (image.pixels.is_signed ? "i" : "u") + std::to_string(image.pixels.sample_bytes() * 8);
}

class DicomDatasets final : public DatasetFile {
 public:
  DicomDatasets(DicomScan scan, DicomSources sources, WorldBudget budget)
      : scan_(std::make_shared<const DicomScan>(std::move(scan))),
        sources_(std::move(sources)),
        budget_(std::move(budget)) {
    for (const DicomSeries& series : scan_->series) {
      const DicomImage& image = scan_->images[series.image];
      DatasetEntry entry;
      entry.path = '/' + series.path;
      if (series.steps.size() > 1) {
        entry.shape.push_back(series.steps.size());
        entry.axes = "time, ";
      }
      entry.axes += "z, y, x";
      for (const std::uint64_t size :
           {std::uint64_t{series.slices()}, std::uint64_t{image.pixels.rows}, std::uint64_t{image.pixels.columns}})
        entry.shape.push_back(size);
      entry.type = type_name_of(image);
      entry.unit = image.unit;
      entry.form = DatasetForm::volume;
      for (const std::string& note : series.notes) entry.note += (entry.note.empty() ? "" : "; ") + note;
      // The series are in the order of their size.
      entry.rank = static_cast<double>(scan_->series.size() - entries_.size());
      entries_.push_back(std::move(entry));
    }
  }

  const std::vector<DatasetEntry>& entries() const override { return entries_; }
  VolumeResult volume(std::size_t entry, const VoxelComponent& choice) override {
    VolumeResult result = dicom_volume(scan_, entry, sources_, choice, budget_);
    if (auto* const volume = std::get_if<qnv::VolumeSource>(&result))
      add_metadata(volume->layout, "dataset", entries_[entry].path);
    return result;
  }
  void mesh(std::size_t, const VoxelComponent&, MeshBuilder&) override {}

 private:
  std::shared_ptr<const DicomScan> scan_;
  DicomSources sources_;
  WorldBudget budget_;
  std::vector<DatasetEntry> entries_;
};

/// Returns the names of the files in the folder that is opened.
std::variant<std::vector<std::string>, std::string> files_of_folder(const VolumeFile& file) {
  const BytesResult list = file.read_beside ? file.read_beside(kFolderReference) : BytesResult("not known");
  if (const auto* problem = std::get_if<std::string>(&list)) return "the files of the folder: " + *problem;
  std::string_view text = text_of(std::get<SharedBytes>(list).bytes);
  std::vector<std::string> names;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    names.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  if (names.empty()) return std::string("the folder has no files");
  return names;
}

/// Returns the names of the files in a directory of a medium (DICOMDIR; PS3.3, annex F).
std::vector<std::string> files_of_directory(const DicomDataSet& data) {
  constexpr std::size_t kMostFiles = 100'000;
  std::vector<std::string> names;
  for (const DicomDataSet& record : data.items(DicomTag::directory_records)) {
    std::string name(record.text(DicomTag::referenced_file));
    std::ranges::replace(name, '\\', '/');
    if (name.empty() || name.find("..") != std::string::npos || names.size() >= kMostFiles) continue;
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace

DatasetFileResult open_dicom_datasets(const VolumeFile& file) {
  DicomSources sources;
  sources.content = file.content;
  if (!file.component.folder.empty()) {
    const auto names = files_of_folder(file);
    if (const auto* problem = std::get_if<std::string>(&names)) return *problem;
    sources.names = std::get<std::vector<std::string>>(names);
  } else {
    const auto parsed = read_dicom_file(file.content, file.budget);
    if (const auto* one = std::get_if<DicomFile>(&parsed); one && one->data.find(DicomTag::directory_records)) {
      sources.names = files_of_directory(one->data);
      if (sources.names.empty()) return std::string("a directory without files");
    }
  }
  if (!sources.names.empty()) {
    sources.content = {};
    sources.read = [read = file.read_beside](const std::string& name) -> BytesResult {
      if (!read) return std::string("other files are not read here");
      return read(net::reference_of_path(name));
    };
  }
  auto scan = scan_dicom(sources, file.budget);
  if (auto* problem = std::get_if<std::string>(&scan)) return std::move(*problem);
  return std::make_unique<DicomDatasets>(std::get<DicomScan>(std::move(scan)), std::move(sources), file.budget);
}

}  // namespace gs::app

#include "app/formats/dicom/dicom_volume.h"

#include "app/formats/dicom/dicom_frame.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

/// Bytes of the files of a series, by their numbers in the scan. Other files are empty.
struct DicomFiles {
  std::vector<SharedBytes> all;
  Share share;
};

/// Reads the files of a series. They are kept, because a confined process cannot ask for them later.
std::variant<std::shared_ptr<const DicomFiles>, std::string> files_of(const DicomScan& scan, const DicomSeries& series,
                                                                      const DicomSources& sources,
                                                                      const WorldBudget& budget) {
  constexpr std::size_t kMostMapped = 200;  // open files at a time
  auto files = std::make_shared<DicomFiles>();
  files->share = Share(budget, Resource::volumes);
  files->all.resize(scan.images.size());
  if (sources.names.empty()) {
    files->all.front() = sources.content;
    return files;
  }
  std::size_t mapped = 0;
  for (const DicomPlane& plane : series.planes) {
    SharedBytes& file = files->all[plane.file];
    if (!file.bytes.empty()) continue;
    BytesResult read = sources.read(scan.images[plane.file].name);
    if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
    file = std::get<SharedBytes>(std::move(read));
    if (file.file && ++mapped <= kMostMapped) continue;
    if (!files->share.grow(file.bytes.size())) return "the files are " + budget->refusal(Resource::volumes);
    if (file.file) file = shared_bytes(std::vector(file.bytes.begin(), file.bytes.end()));
  }
  return files;
}

/// Decoder of the frames of a scan. Keeps the last file and frames. Any thread.
class DicomDecoder {
 public:
  DicomDecoder(std::shared_ptr<const DicomScan> scan, std::shared_ptr<const DicomFiles> files, WorldBudget budget)
      : scan_(std::move(scan)), files_(std::move(files)), budget_(std::move(budget)) {}

  using Frame = std::shared_ptr<const std::vector<std::byte>>;

  /// Returns the decoded samples of a frame, colours as red, green and blue. Returns null on failure.
  [[nodiscard]] Frame frame(const DicomPlane& plane) {
    const std::lock_guard lock(mutex_);
    for (const Kept& kept : frames_)
      if (kept.file == plane.file && kept.frame == plane.frame) return kept.samples;
    const DicomImage& image = scan_->images[plane.file];
    const std::shared_ptr<const DicomFile> file = file_of(plane.file);
    if (!file || budget_->stopped()) return nullptr;
    std::vector<std::byte> samples;
    if (decode_dicom_frame(*file, image.pixels, plane.frame, samples)) return nullptr;
    if (image.pixels.color != DicomColor::gray) dicom_colors(image, samples);
    if (frames_.size() >= kFrames) frames_.erase(frames_.begin());
    frames_.push_back({plane.file, plane.frame, std::make_shared<const std::vector<std::byte>>(std::move(samples))});
    return frames_.back().samples;
  }

  static constexpr std::size_t kFrames = 3;  // mixed slices need two

 private:
  struct Kept {
    std::uint32_t file = 0, frame = 0;
    Frame samples;
  };

  // Parses a file of the scan again. It must still have the same pixels.
  [[nodiscard]] std::shared_ptr<const DicomFile> file_of(std::uint32_t number) {
    if (file_ && file_number_ == number) return file_;
    auto parsed = read_dicom_file(files_->all[number], budget_);
    auto* file = std::get_if<DicomFile>(&parsed);
    if (!file) return nullptr;
    const auto image = read_dicom_image(*file, {});
    const auto* same = std::get_if<DicomImage>(&image);
    if (!same || same->pixels != scan_->images[number].pixels) return nullptr;
    // Only the pixels are needed from here on.
    std::erase_if(file->data.elements, [](const DicomElement& element) {
      return form_of(element.tag) != DicomForm::bytes && element.tag != DicomTag::extended_offsets;
    });
    file_ = std::make_shared<const DicomFile>(std::move(*file));
    file_number_ = number;
    return file_;
  }

  std::shared_ptr<const DicomScan> scan_;
  std::shared_ptr<const DicomFiles> files_;
  WorldBudget budget_;
  std::mutex mutex_;
  std::vector<Kept> frames_;
  std::shared_ptr<const DicomFile> file_;
  std::uint32_t file_number_ = 0;
};

StoredType stored_type_of(const DicomPixels& pixels) {
  if (pixels.form == DicomSamples::f32) return StoredType::f32;
  if (pixels.form == DicomSamples::f64) return StoredType::f64;
  switch (pixels.sample_bytes()) {
    case 1:
      return pixels.is_signed ? StoredType::i8 : StoredType::u8;
    case 2:
      return pixels.is_signed ? StoredType::i16 : StoredType::u16;
    case 4:
      return pixels.is_signed ? StoredType::i32 : StoredType::u32;
    default:
      return pixels.is_signed ? StoredType::i64 : StoredType::u64;
  }
}

/// Form that the numbers of a slice get.
enum class DicomOutput : std::uint8_t { stored, values, wide, labels, colors, length };

/// Reader of the slices of one step. Copyable; all copies share the decoder.
struct SliceReader {
  std::shared_ptr<const DicomScan> scan;
  std::shared_ptr<DicomDecoder> decoder;
  std::size_t series = 0, step = 0;
  DicomOutput output = DicomOutput::stored;
  std::size_t channel = 0;  // of colours
  bool wide_labels = false;

  bool operator()(std::uint32_t z, std::span<std::byte> to) const {
    const DicomSeries& of = scan->series[series];
    if (z >= of.slices()) return false;
    const DicomSlice& slice = of.steps[step][z];
    switch (output) {
      case DicomOutput::stored: {
        const auto frame = decoder->frame(of.planes[slice.planes.front()]);
        if (!frame || frame->size() != to.size()) return false;
        std::ranges::copy(*frame, to.begin());
        return true;
      }
      case DicomOutput::values:
        return values<float>(of, slice, to);
      case DicomOutput::wide:
        return values<double>(of, slice, to);
      case DicomOutput::labels:
        return wide_labels ? numbers<std::uint16_t>(of, slice, to) : numbers<std::uint8_t>(of, slice, to);
      case DicomOutput::colors:
      case DicomOutput::length:
        return colors(of, slice, to);
    }
    return false;
  }

 private:
  // Writes the values of a plane, scaled and perhaps mixed with those of a second one. Missing slices are NaN.
  template <class T>
  bool values(const DicomSeries& of, const DicomSlice& slice, std::span<std::byte> to) const {
    const DicomImage& image = scan->images[of.image];
    const std::size_t count = to.size() / sizeof(T);
    std::vector<double> sums(count, slice.planes.empty() ? NAN : 0.0);
    for (std::size_t i = 0; i < slice.planes.size(); ++i) {
      const DicomPlane& plane = of.planes[slice.planes[i]];
      const auto frame = decoder->frame(plane);
      const double weight = i == 0 ? 1 - slice.share : slice.share;
      if (!frame) return false;
      const bool good = with_stored_type(stored_type_of(image.pixels), [&](auto kind) {
        using Stored = decltype(kind);
        if (frame->size() != count * sizeof(Stored)) return false;
        for (std::size_t k = 0; k < count; ++k) {
          Stored stored;
          std::memcpy(&stored, frame->data() + k * sizeof(Stored), sizeof(Stored));
          const auto number = static_cast<double>(stored);
          sums[k] +=
              image.missing && number == *image.missing ? NAN : weight * (number * plane.slope + plane.intercept);
        }
        return true;
      });
      if (!good) return false;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const T value = static_cast<T>(sums[k]);
      std::memcpy(to.data() + k * sizeof(T), &value, sizeof(T));
    }
    return true;
  }

  // Writes the numbers of segments: of frames with one segment each, or as stored.
  template <class T>
  bool numbers(const DicomSeries& of, const DicomSlice& slice, std::span<std::byte> to) const {
    const DicomImage& image = scan->images[of.image];
    const std::size_t count = to.size() / sizeof(T), width = image.pixels.sample_bytes();
    std::vector<T> labels(count, T{0});
    for (const std::uint32_t number : slice.planes) {
      const DicomPlane& plane = of.planes[number];
      const auto frame = decoder->frame(plane);
      if (!frame || frame->size() != count * width) return false;
      for (std::size_t k = 0; k < count; ++k) {
        std::uint32_t stored = 0;
        std::memcpy(&stored, frame->data() + k * width, std::min<std::size_t>(width, sizeof(stored)));
        const bool own = image.segments == DicomSegments::labels;
        if (stored != 0) labels[k] = std::max(labels[k], static_cast<T>(own ? stored : plane.segment));
      }
    }
    std::memcpy(to.data(), labels.data(), to.size());
    return true;
  }

  // Writes one channel of colours, or their length.
  bool colors(const DicomSeries& of, const DicomSlice& slice, std::span<std::byte> to) const {
    std::ranges::fill(to, std::byte{0});
    if (slice.planes.empty()) return true;  // black
    const auto frame = decoder->frame(of.planes[slice.planes.front()]);
    if (!frame) return false;
    if (output == DicomOutput::colors) {
      if (frame->size() != to.size() * 3) return false;
      for (std::size_t k = 0; k < to.size(); ++k) to[k] = (*frame)[k * 3 + channel];
      return true;
    }
    if (frame->size() * sizeof(float) != to.size() * 3) return false;
    for (std::size_t k = 0; k < frame->size() / 3; ++k) {
      float square = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto part = static_cast<float>(std::to_integer<int>((*frame)[k * 3 + i]));
        square += part * part;
      }
      const float length = std::sqrt(square);
      std::memcpy(to.data() + k * sizeof(float), &length, sizeof(length));
    }
    return true;
  }
};

/// Makes pictures face the viewer: their first row is on top.
void face_viewer(qnv::VolumeLayout& layout) {
  add_metadata(layout, "up", "-y");
  add_metadata(layout, "front", "-z");
}

/// Returns the axis along a direction, or an empty text if there is none.
std::string axis_along(const glm::dvec3& direction) {
  constexpr double kNear = 0.999;
  const glm::dvec3 unit = glm::normalize(direction);
  for (int i = 0; i < 3; ++i)
    if (std::abs(unit[i]) > kNear) return std::string(unit[i] < 0 ? "-" : "") + "xyz"[i];
  return {};
}

qnv::VolumeLayout layout_of(const DicomImage& image, const DicomSeries& series) {
  qnv::VolumeLayout layout;
  layout.dimensions = {image.pixels.columns, image.pixels.rows, static_cast<std::uint32_t>(series.slices())};
  for (std::size_t i = 0; i < 3; ++i) layout.axes[i] = glm::vec3(series.axes[i]);
  layout.origin = series.origin;
  add_metadata(layout, "modality", image.modality);
  if (image.planes.front().spaced || series.placed) add_metadata(layout, "space units", "mm");
  if (image.pixels.color == DicomColor::gray) add_metadata(layout, "units", image.unit);
  if (image.window)
    add_metadata(layout, "window",
                 dicom_number_text(image.window->first) + ' ' + dicom_number_text(image.window->second));
  if (image.pixels.inverted) add_metadata(layout, "photometric", "MONOCHROME1");
  for (const std::string& note : series.notes) add_metadata(layout, "note", note);
  if (!series.placed) {
    face_viewer(layout);
  } else if (series.slices() == 1) {
    // The patient stands upright, so that a single slice could be seen from its edge only.
    const std::string up = axis_along(-series.axes[1]), across = axis_along(series.axes[0]);
    if (!up.empty() && !across.empty()) {
      add_metadata(layout, "up", up);
      add_metadata(layout, "front", axis_along(-glm::cross(series.axes[0], series.axes[1])));
    } else {
      for (std::size_t i = 0; i < 3; ++i) {
        layout.axes[i] = glm::vec3(0);
        layout.axes[i][static_cast<int>(i)] = static_cast<float>(glm::length(series.axes[i]));
      }
      layout.origin = glm::dvec3(0);
      add_metadata(layout, "note", "an oblique slice, shown as a picture without its place");
      face_viewer(layout);
    }
  }
  return layout;
}

/// Chooses what the numbers of a series become, and completes its layout.
std::variant<DicomOutput, std::string> output_of(const DicomScan& scan, const DicomSeries& series,
                                                 VoxelComponent component, qnv::VolumeLayout& layout) {
  const DicomImage& image = scan.images[series.image];
  layout.big_endian = std::endian::native == std::endian::big;
  if (image.pixels.color != DicomColor::gray) {
    if (component.chosen && !component.magnitude && component.index > 2)
      return "no component " + std::to_string(component.index) + "; expected 0 to 2, or magnitude";
    layout.type = component.magnitude ? qnv::VoxelType::f32 : qnv::VoxelType::u8;
    layout.colors = !component.chosen && !component.magnitude;
    return component.magnitude ? DicomOutput::length : DicomOutput::colors;
  }
  if (component.chosen && !component.magnitude && component.index > 0)
    return "no component " + std::to_string(component.index) + "; expected 0, because each voxel has one number";
  if (image.segments == DicomSegments::binary || image.segments == DicomSegments::labels) {
    std::uint32_t most = image.segments == DicomSegments::labels && image.pixels.sample_bytes() > 1 ? 65535 : 0;
    for (const DicomPlane& plane : series.planes) most = std::max(most, plane.segment);
    layout.type = most > 255 ? qnv::VoxelType::u16 : qnv::VoxelType::u8;
    layout.labels = component.labels.value_or(true);
    return DicomOutput::labels;
  }
  layout.labels = component.labels.value_or(false);
  const DicomPlane& first = series.planes.front();
  bool stored = series.missing == 0 && image.pixels.form == DicomSamples::integers && image.pixels.sample_bytes() < 8;
  for (const DicomPlane& plane : series.planes)
    stored = stored && plane.slope == first.slope && plane.intercept == first.intercept;
  for (const auto& step : series.steps)
    for (const DicomSlice& slice : step) stored = stored && slice.share == 0;
  for (const DicomPlane& plane : series.planes) stored = stored && scan.images[plane.file].missing == image.missing;
  if (stored) {
    layout.type = static_cast<qnv::VoxelType>(stored_type_of(image.pixels));
    layout.slope = first.slope;
    layout.intercept = first.intercept;
    layout.missing = image.missing;
    return DicomOutput::stored;
  }
  const bool wide = image.pixels.form == DicomSamples::f64 || image.pixels.sample_bytes() == 8;
  layout.type = wide ? qnv::VoxelType::f64 : qnv::VoxelType::f32;
  return wide ? DicomOutput::wide : DicomOutput::values;
}

}  // namespace

std::variant<DicomScan, std::string> scan_dicom(const DicomSources& sources, const WorldBudget& budget) {
  DicomScan scan;
  if (sources.names.empty()) {
    auto file = read_dicom_file(sources.content, budget);
    if (auto* problem = std::get_if<std::string>(&file)) return std::move(*problem);
    auto image = read_dicom_image(std::get<DicomFile>(file), {});
    if (auto* problem = std::get_if<std::string>(&image)) return std::move(*problem);
    scan.images.push_back(std::get<DicomImage>(std::move(image)));
  }
  std::size_t damaged = 0;
  std::string first_problem;
  Share share(budget, Resource::volumes);
  for (const std::string& name : sources.names) {
    if (budget->stopped()) break;
    BytesResult read = sources.read(name);
    auto* content = std::get_if<SharedBytes>(&read);
    if (!content || !is_dicom(content->bytes)) continue;
    const auto fail = [&](const std::string& problem) {
      if (damaged++ == 0) first_problem = name + ": " + problem;
    };
    auto file = read_dicom_file(std::move(*content), budget);
    if (const auto* problem = std::get_if<std::string>(&file)) {
      fail(*problem);
      continue;
    }
    const DicomDataSet& data = std::get<DicomFile>(file).data;
    if (!data.find(DicomTag::rows) && !data.find(DicomTag::pixels)) continue;  // a directory, plan or report
    auto image = read_dicom_image(std::get<DicomFile>(file), name);
    if (const auto* problem = std::get_if<std::string>(&image)) {
      fail(*problem);
      continue;
    }
    scan.images.push_back(std::get<DicomImage>(std::move(image)));
    if (!share.grow(sizeof(DicomImage) + scan.images.back().planes.size() * sizeof(DicomPlane)))
      return "the headers of the files are " + budget->refusal(Resource::volumes);
  }
  if (damaged > 0)
    scan.notes.push_back(first_problem + (damaged > 1 ? " (" + std::to_string(damaged) + " such files)" : "") +
                         "; left out");
  if (scan.images.empty()) return damaged > 0 ? first_problem : std::string("no DICOM image in the folder");
  scan.series = dicom_series(scan.images);
  return scan;
}

VolumeResult dicom_volume(const std::shared_ptr<const DicomScan>& scan, std::size_t number, const DicomSources& sources,
                          VoxelComponent component, const WorldBudget& budget) {
  const DicomSeries& series = scan->series[number];
  const DicomImage& image = scan->images[series.image];
  qnv::VolumeLayout layout = layout_of(image, series);
  const auto output = output_of(*scan, series, component, layout);
  if (const auto* problem = std::get_if<std::string>(&output)) return *problem;
  if (scan->images.size() == 1 && image.pixels.frames == 1 && image.planes.front().position)
    add_metadata(layout, "note", "one slice; open its folder for the whole series");
  for (const std::string& note : scan->notes) add_metadata(layout, "note", note);
  mend(layout);
  set_base(layout);
  if (const auto problem = qnv::check(layout)) return problem->message;
  const std::uint64_t frame = image.pixels.frame_samples() * std::max<std::uint64_t>(image.pixels.sample_bytes(), 3);
  if (frame > budget->left(Resource::volumes) / (DicomDecoder::kFrames + 1))
    return "frames of " + std::to_string(image.pixels.rows) + " x " + std::to_string(image.pixels.columns) +
           " pixels take " + budget->refusal(Resource::volumes);
  SliceReader reader;
  reader.scan = scan;
  auto files = files_of(*scan, series, sources, budget);
  if (auto* problem = std::get_if<std::string>(&files)) return std::move(*problem);
  reader.decoder =
      std::make_shared<DicomDecoder>(scan, std::get<std::shared_ptr<const DicomFiles>>(std::move(files)), budget);
  reader.series = number;
  reader.output = std::get<DicomOutput>(output);
  reader.wide_labels = layout.type == qnv::VoxelType::u16;
  const auto at = [&](std::size_t step) {
    SliceReader one = reader;
    one.step = step;
    one.channel = component.chosen ? component.index : 0;
    if (!layout.colors) return qnv::VolumeSource{layout, one};
    std::vector<qnv::VolumeSource> channels;
    for (one.channel = 0; one.channel < 3; ++one.channel) channels.push_back({layout, one});
    return qnv::color_source(std::move(channels));
  };
  const std::size_t count = layout.labels ? 1 : series.steps.size();
  if (component.step && count > 1) {
    if (!component.step->time && component.step->number >= count)
      return "no step " + std::to_string(component.step->number) + "; expected 0 to " + std::to_string(count - 1);
    return at(qnv::step_number(*component.step, series.times));
  }
  if (count < 2) return at(0);
  std::vector<qnv::VolumeSource> steps;
  for (std::size_t step = 0; step < count; ++step) steps.push_back(at(step));
  qnv::VolumeSource source = steps.front();
  source.steps = std::move(steps);
  source.times = series.times;
  return source;
}

}  // namespace gs::app

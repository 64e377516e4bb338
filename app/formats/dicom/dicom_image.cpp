#include "app/formats/dicom/dicom_image.h"

#include "app/formats/dicom/dicom_palette.h"
#include "app/formats/volume/volume_common.h"
#include "base/text.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint32_t kMostFrames = 65'536;

/// Sources of the attributes of a frame: its own functional groups, those of all frames, and the data set itself.
struct FrameSources {
  const DicomDataSet* own = nullptr;
  const DicomDataSet* shared = nullptr;
  const DicomDataSet& data;

  /// Returns the item of the functional group `macro` for this frame, or null.
  [[nodiscard]] const DicomDataSet* macro(DicomTag tag) const {
    if (own)
      if (const DicomDataSet* item = own->item(tag)) return item;
    return shared ? shared->item(tag) : nullptr;
  }
  /// Returns the numbers of an attribute, in a functional group or else in the data set.
  [[nodiscard]] std::vector<double> numbers(DicomTag group, DicomTag tag, std::size_t most) const {
    if (const DicomDataSet* item = macro(group))
      if (std::vector<double> found = item->numbers(tag, most); !found.empty()) return found;
    return data.numbers(tag, most);
  }
  [[nodiscard]] std::optional<double> number(DicomTag group, DicomTag tag) const {
    const std::vector<double> found = numbers(group, tag, 1);
    return !found.empty() && std::isfinite(found[0]) ? std::optional(found[0]) : std::nullopt;
  }
};

bool all_finite(const std::vector<double>& numbers, std::size_t count) {
  return numbers.size() == count && std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

std::optional<glm::dvec3> position_of(const std::vector<double>& numbers) {
  constexpr double kMost = 1e7;
  if (!all_finite(numbers, 3) || std::ranges::any_of(numbers, [](double n) { return std::abs(n) > kMost; }))
    return std::nullopt;
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

/// Converts a time of day such as 102931.25 (TM) to seconds.
double seconds_of_day(std::string_view text) {
  const std::vector<double> numbers = numbers_of(text, 1);
  if (numbers.empty() || text.size() < 6 || text.find(':') != std::string_view::npos) return NAN;
  const double hours = std::floor(numbers[0] / 10'000), minutes = std::floor(std::fmod(numbers[0], 10'000) / 100);
  return hours * 3600 + minutes * 60 + std::fmod(numbers[0], 100);
}

void orient(const std::vector<double>& numbers, DicomPlane& plane) {
  if (!all_finite(numbers, 6)) return;
  const glm::dvec3 row(numbers[0], numbers[1], numbers[2]), column(numbers[3], numbers[4], numbers[5]);
  constexpr double kMin = 0.5, kMost = 2, kSkew = 0.1;
  const auto usual = [](double length) { return length > kMin && length < kMost; };
  if (!usual(glm::length(row)) || !usual(glm::length(column))) return;
  if (std::abs(glm::dot(glm::normalize(row), glm::normalize(column))) > kSkew) return;
  plane.oriented = true;
  plane.row = glm::normalize(row);
  plane.column = glm::normalize(column);
}

bool set_spacing(const std::vector<double>& rows_columns, DicomPlane& plane) {
  constexpr double kMost = 1e6;
  if (rows_columns.size() != 2) return false;
  for (const double number : rows_columns)
    if (!(number > 0 && number < kMost)) return false;
  plane.spacing = {rows_columns[1], rows_columns[0]};
  return true;
}

/// Sets the distances of pixels, also from the region of an ultrasound image or from the ratio of its pixels.
void space(const FrameSources& from, DicomPlane& plane) {
  plane.spaced = set_spacing(from.numbers(DicomTag::pixel_measures, DicomTag::pixel_spacing, 2), plane) ||
                 set_spacing(from.data.numbers(DicomTag::imager_pixel_spacing, 2), plane);
  if (plane.spaced) return;
  if (const DicomDataSet* region = from.data.item(DicomTag::ultrasound_regions)) {
    constexpr std::uint32_t kCentimetres = 3;
    const auto x = region->number(DicomTag::physical_delta_x), y = region->number(DicomTag::physical_delta_y);
    if (x && y && region->whole(DicomTag::physical_units_x, 0) == kCentimetres &&
        region->whole(DicomTag::physical_units_y, 0) == kCentimetres)
      plane.spaced = set_spacing({std::abs(*y) * 10, std::abs(*x) * 10}, plane);
  }
  if (!plane.spaced) (void)set_spacing(from.data.numbers(DicomTag::aspect_ratio, 2), plane);
}

void scale(const FrameSources& from, DicomPlane& plane) {
  const auto slope = from.number(DicomTag::pixel_transformation, DicomTag::rescale_slope);
  const auto intercept = from.number(DicomTag::pixel_transformation, DicomTag::rescale_intercept);
  if (slope && *slope != 0) plane.slope = *slope;
  if (intercept) plane.intercept = *intercept;
  if (const auto dose = from.data.number(DicomTag::dose_scaling); dose && *dose != 0) plane.slope = *dose;
}

/// Returns the kind of frame: type of image, echo and stack. No free text is part of it.
std::string kind_of(const FrameSources& from) {
  std::string kind;
  for (const DicomTag group : {DicomTag::mr_frame_type, DicomTag::ct_frame_type})
    if (const DicomDataSet* item = from.macro(group); item && kind.empty()) kind = item->text(DicomTag::frame_type);
  if (kind.empty()) kind = from.data.text(DicomTag::image_type);
  kind = kind.substr(0, 128);
  const auto add = [&](std::optional<double> number) {
    if (number) kind += '\n' + std::to_string(*number);
  };
  add(from.data.number(DicomTag::echo_numbers));
  add(from.number(DicomTag::mr_echo, DicomTag::effective_echo_time));
  if (const DicomDataSet* content = from.macro(DicomTag::frame_content))
    kind += '\n' + std::string(content->text(DicomTag::stack_id));
  return kind;
}

void set_time(const FrameSources& from, DicomPlane& plane) {
  plane.temporal = from.data.whole(DicomTag::temporal_position, 0);
  const DicomDataSet* content = from.macro(DicomTag::frame_content);
  if (content) plane.temporal = content->whole(DicomTag::temporal_position_index, plane.temporal);
  if (const DicomDataSet* position = from.macro(DicomTag::temporal_positions))
    if (const auto offset = position->number(DicomTag::temporal_offset)) plane.time = *offset;
  constexpr double kMilli = 1000;
  for (const DicomTag tag : {DicomTag::frame_reference_time, DicomTag::trigger_time})
    if (const auto time = from.data.number(tag); time && std::isnan(plane.time)) plane.time = *time / kMilli;
  for (const DicomTag tag : {DicomTag::acquisition_time, DicomTag::content_time})
    if (std::isnan(plane.time)) plane.time = seconds_of_day(from.data.text(tag));
  if (const auto b = from.number(DicomTag::mr_diffusion, DicomTag::diffusion_b_value)) plane.b_value = *b;
}

DicomPlane plane_of(const FrameSources& from) {
  DicomPlane plane;
  plane.position = position_of(from.numbers(DicomTag::plane_position, DicomTag::image_position, 3));
  orient(from.numbers(DicomTag::plane_orientation, DicomTag::image_orientation, 6), plane);
  // Nuclear medicine has the place of its first frame in the information of the detector.
  if (const DicomDataSet* detector = from.data.item(DicomTag::detector_information)) {
    if (!plane.position) plane.position = position_of(detector->numbers(DicomTag::image_position, 3));
    if (!plane.oriented) orient(detector->numbers(DicomTag::image_orientation, 6), plane);
  }
  space(from, plane);
  for (const DicomTag tag : {DicomTag::spacing_between_slices, DicomTag::slice_thickness})
    if (const auto distance = from.number(DicomTag::pixel_measures, tag); distance && plane.between == 0)
      plane.between = std::abs(*distance);
  scale(from, plane);
  plane.kind = kind_of(from);
  set_time(from, plane);
  plane.instance = from.data.whole(DicomTag::instance_number, 0);
  plane.acquisition = from.data.whole(DicomTag::acquisition_number, 0);
  if (const DicomDataSet* segment = from.macro(DicomTag::segment_identification))
    plane.segment = segment->whole(DicomTag::segment_number, 0);
  return plane;
}

/// Places the frames of a volume without functional groups along its normal.
void stack_frames(const DicomDataSet& data, DicomImage& image) {
  const std::vector<double> offsets = data.numbers(DicomTag::frame_offsets, image.planes.size());
  const bool stated = all_finite(offsets, image.planes.size());
  const DicomPlane first = image.planes.front();
  if (!first.position || !first.oriented) return;
  const glm::dvec3 normal = glm::cross(first.row, first.column);
  // The offsets are relative to the first frame, or coordinates of an axis of the patient (PS3.3, C.8.8.3.2).
  const double base = stated && offsets[0] == 0 ? 0 : stated ? offsets[0] : 0;
  const double between = first.between > 0 ? first.between : 1;
  for (std::size_t i = 0; i < image.planes.size(); ++i)
    image.planes[i].position =
        *first.position + normal * (stated ? offsets[i] - base : between * static_cast<double>(i));
}

/// Sets the times of frames that follow each other in time.
void time_frames(const DicomDataSet& data, DicomImage& image) {
  const std::vector<double> apart = data.numbers(DicomTag::frame_time_vector, image.planes.size());
  const double step = data.number(DicomTag::frame_time).value_or(1000);
  double time = 0;
  constexpr double kMilli = 1000;
  for (std::size_t i = 0; i < image.planes.size(); ++i) {
    if (i > 0) time += i < apart.size() && std::isfinite(apart[i]) ? apart[i] : step;
    image.planes[i].time = time / kMilli;
    image.planes[i].temporal = static_cast<std::uint32_t>(i + 1);
  }
}

std::optional<std::string> read_pixels(const DicomFile& file, DicomPixels& pixels) {
  const DicomDataSet& data = file.data;
  pixels.rows = data.whole(DicomTag::rows, 0);
  pixels.columns = data.whole(DicomTag::columns, 0);
  if (pixels.rows == 0 || pixels.columns == 0) return std::string("no image; expected its rows and columns");
  pixels.samples = data.whole(DicomTag::samples, 1);
  pixels.bits_allocated = data.whole(DicomTag::bits_allocated, 16);
  pixels.bits_stored = data.whole(DicomTag::bits_stored, pixels.bits_allocated);
  pixels.high_bit = data.whole(DicomTag::high_bit, pixels.bits_stored - 1);
  pixels.is_signed = data.whole(DicomTag::pixel_representation, 0) == 1;
  pixels.planar = data.whole(DicomTag::planar, 0) == 1;
  const double count = data.number(DicomTag::frames).value_or(1);
  if (!(count >= 0 && count <= kMostFrames))
    return "the number of frames is not valid; expected 1 to " + std::to_string(kMostFrames);
  pixels.frames = std::max(1u, static_cast<std::uint32_t>(count));
  if (data.find(DicomTag::float_pixels)) pixels.form = DicomSamples::f32;
  if (data.find(DicomTag::double_pixels)) pixels.form = DicomSamples::f64;
  if (pixels.form != DicomSamples::integers)
    pixels.bits_allocated = pixels.bits_stored = pixels.form == DicomSamples::f32 ? 32 : 64;
  constexpr std::array<std::uint32_t, 6> kBits{1, 8, 12, 16, 32, 64};
  if (std::ranges::find(kBits, pixels.bits_allocated) == kBits.end())
    return std::to_string(pixels.bits_allocated) + " bits per sample; expected 1, 8, 12, 16, 32 or 64";
  if (pixels.bits_stored == 0 || pixels.bits_stored > pixels.bits_allocated) pixels.bits_stored = pixels.bits_allocated;
  if (pixels.high_bit >= pixels.bits_allocated || pixels.high_bit + 1 < pixels.bits_stored)
    pixels.high_bit = pixels.bits_stored - 1;
  const std::string_view color = data.text(DicomTag::photometric);
  pixels.inverted = color == "MONOCHROME1";
  if (color == "PALETTE COLOR") pixels.color = DicomColor::palette;
  if (color == "RGB" || color == "YBR_ICT" || color == "YBR_RCT") pixels.color = DicomColor::rgb;
  if (color == "YBR_FULL") pixels.color = DicomColor::ybr_full;
  if (color == "YBR_FULL_422" || color == "YBR_PARTIAL_422") pixels.color = DicomColor::ybr_full_422;
  const bool colored = pixels.color != DicomColor::gray && pixels.color != DicomColor::palette;
  if (pixels.samples != (colored ? 3u : 1u))
    return std::to_string(pixels.samples) + " samples per pixel; expected " + (colored ? "3" : "1");
  if (colored && pixels.bits_allocated != 8 && pixels.bits_allocated != 16)
    return "colours of " + std::to_string(pixels.bits_allocated) + " bits; expected 8 or 16";
  return std::nullopt;
}

/// Returns a message if pixels are missing.
std::optional<std::string> check_pixels(const DicomFile& file, const DicomPixels& pixels) {
  if (file.codec == DicomCodec::unknown)
    return "the transfer syntax " + file.syntax + " is unknown; expected uncompressed, RLE or JPEG";
  if (!file.fragments.empty()) {
    if (file.fragments.size() - 1 < pixels.frames)
      return "the pixels end after " + std::to_string(file.fragments.size() - 1) + " of " +
             std::to_string(pixels.frames) + " frames";
    return std::nullopt;
  }
  const DicomElement* element = nullptr;
  for (const DicomTag tag : {DicomTag::pixels, DicomTag::float_pixels, DicomTag::double_pixels})
    if (!element) element = file.data.find(tag);
  if (!element) return std::string("no pixels");
  if (file.codec != DicomCodec::native) return std::string("the compressed pixels are missing");
  const bool halved = pixels.color == DicomColor::ybr_full_422;
  const std::uint64_t bits = pixels.frame_samples() * pixels.bits_allocated * pixels.frames;
  const std::uint64_t needed = (halved ? bits / 3 * 2 : bits) / 8 + (bits % 8 != 0 ? 1 : 0);
  if (element->value.size() < needed)
    return "the pixels end after " + std::to_string(element->value.size()) + " bytes; expected " +
           std::to_string(needed);
  return std::nullopt;
}

/// Sets the unit of the values.
void set_unit(const DicomDataSet& data, DicomImage& image) {
  const std::string_view unit = data.text(DicomTag::units), dose = data.text(DicomTag::dose_units);
  const std::string_view type = data.text(DicomTag::rescale_type);
  if (image.segments != DicomSegments::none) return;
  const bool rescaled = data.find(DicomTag::rescale_slope) || data.find(DicomTag::pixel_transformation) ||
                        data.find(DicomTag::shared_groups);
  if (image.modality == "CT" && rescaled && (type.empty() || type == "HU")) image.unit = "HU";
  static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"BQML", "Bq/mL"}, {"CNTS", "counts"},     {"GML", "g/mL"},    {"CM2ML", "cm2/mL"},
      {"CPS", "1/s"},    {"PROPCNTS", "counts"}, {"PROPCPS", "1/s"}, {"PCNT", "%"}};
  if (const auto known = value_named(kUnits, unit)) image.unit = *known;
  if (dose == "GY") image.unit = "Gy";
  // Values far below air mean that nothing was measured there.
  constexpr double kAir = -1024;
  const auto padding = data.number(DicomTag::padding_value);
  if (image.unit != "HU" || !padding || image.pixels.form != DicomSamples::integers) return;
  double value = *padding;
  if (image.pixels.is_signed && value >= 32768) value -= 65536;
  const DicomPlane& first = image.planes.front();
  if (value * first.slope + first.intercept < kAir) image.missing = value;
}

DicomSegments segments_of(const DicomDataSet& data, const DicomPixels& pixels) {
  constexpr std::string_view kLabelMap = "1.2.840.10008.5.1.4.1.1.66.7";
  const std::string_view type = data.text(DicomTag::segmentation_type);
  if (data.text(DicomTag::sop_class) == kLabelMap || type == "LABELMAP") return DicomSegments::labels;
  if (type == "FRACTIONAL") return DicomSegments::fractional;
  return type == "BINARY" || pixels.bits_allocated == 1 ? DicomSegments::binary : DicomSegments::none;
}

}  // namespace

std::variant<DicomImage, std::string> read_dicom_image(const DicomFile& file, std::string name) {
  const DicomDataSet& data = file.data;
  DicomImage image;
  image.name = std::move(name);
  if (auto problem = read_pixels(file, image.pixels)) return std::move(*problem);
  if (auto problem = check_pixels(file, image.pixels)) return std::move(*problem);
  image.series = data.text(DicomTag::series_uid).substr(0, 64);
  image.series_number = data.whole(DicomTag::series_number, 0);
  for (const char c : data.text(DicomTag::modality).substr(0, 16))  // a coded string: letters and digits
    if ((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) image.modality += c;
  image.segments = segments_of(data, image.pixels);
  if (image.pixels.color == DicomColor::palette) {
    auto palette = read_dicom_palette(data, image.pixels.bits_stored);
    if (auto* problem = std::get_if<std::string>(&palette)) return std::move(*problem);
    image.palette = std::get<std::vector<DicomTable>>(std::move(palette));
  }
  // Values of maps, such as diffusion, have their own scale.
  constexpr std::string_view kParametricMap = "1.2.840.10008.5.1.4.1.1.30";
  const std::span<const DicomDataSet> groups = data.items(DicomTag::frame_groups);
  for (std::uint32_t frame = 0; frame < image.pixels.frames; ++frame) {
    const FrameSources from{frame < groups.size() ? &groups[frame] : nullptr, data.item(DicomTag::shared_groups), data};
    // Without functional groups, all frames have the same attributes.
    if (frame > 0 && groups.empty())
      image.planes.push_back(image.planes.front());
    else
      image.planes.push_back(plane_of(from));
    DicomPlane& plane = image.planes.back();
    plane.frame = frame;
    if (const DicomDataSet* mapping = from.macro(DicomTag::real_world_mapping);
        mapping && data.text(DicomTag::sop_class) == kParametricMap) {
      plane.slope = mapping->number(DicomTag::real_world_slope).value_or(1);
      plane.intercept = mapping->number(DicomTag::real_world_intercept).value_or(0);
    }
    if (image.segments == DicomSegments::fractional)
      plane.slope = 1.0 / std::max(1u, data.whole(DicomTag::fraction_maximum, 255));
    if (image.segments == DicomSegments::binary && plane.segment == 0) plane.segment = 1;
    if (image.segments == DicomSegments::fractional) plane.kind += '\n' + std::to_string(plane.segment);
  }
  const std::vector<double> pointer = data.numbers(DicomTag::frame_increment, 2);
  const bool by_time = pointer.size() == 2 && pointer[0] == 0x18 && (pointer[1] == 0x1063 || pointer[1] == 0x1065);
  if (groups.empty() && image.pixels.frames > 1) {
    // Cameras and ultrasound without a place in the patient make movies.
    static constexpr std::array<std::string_view, 6> kMovies{"US", "IVUS", "XA", "RF", "ES", "XC"};
    const bool films = std::ranges::find(kMovies, image.modality) != kMovies.end() && !image.planes.front().position;
    image.moving = by_time || (pointer.empty() &&
                               (films || data.find(DicomTag::frame_time) || data.find(DicomTag::frame_time_vector)));
    if (image.moving)
      time_frames(data, image);
    else
      stack_frames(data, image);
  }
  set_unit(data, image);
  FrameSources first{groups.empty() ? nullptr : groups.data(), data.item(DicomTag::shared_groups), data};
  const auto center = first.number(DicomTag::frame_window, DicomTag::window_center),
             width = first.number(DicomTag::frame_window, DicomTag::window_width);
  if (center && width && *width > 0) image.window = {*center, *width};
  return image;
}

}  // namespace gs::app

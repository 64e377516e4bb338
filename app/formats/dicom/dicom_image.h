#pragma once

#include "app/formats/dicom/dicom_file.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Meaning of the samples of a pixel (PS3.3, C.7.6.3.1.2).
enum class DicomColor : std::uint8_t { gray, rgb, palette, ybr_full, ybr_full_422 };

/// Form of the samples.
enum class DicomSamples : std::uint8_t { integers, f32, f64 };

/// Kind of a segmentation: none, one segment per frame, shares of a segment, or numbers of segments.
enum class DicomSegments : std::uint8_t { none, binary, fractional, labels };

/// Form of the pixels of a file.
struct DicomPixels {
  std::uint32_t rows = 0, columns = 0, frames = 1, samples = 1;
  std::uint32_t bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  bool planar = false;      // the samples of a frame follow each other
  bool inverted = false;    // MONOCHROME1: the smallest value is white
  bool extra_bits = false;  // bits outside of the stored ones may be set
  DicomColor color = DicomColor::gray;
  DicomSamples form = DicomSamples::integers;

  [[nodiscard]] std::uint64_t frame_samples() const { return std::uint64_t{rows} * columns * samples; }
  /// Returns the size of a decoded sample in bytes: 1, 2, 4 or 8.
  [[nodiscard]] std::uint32_t sample_bytes() const {
    return bits_allocated <= 8 ? 1 : bits_allocated <= 16 ? 2 : bits_allocated <= 32 ? 4 : 8;
  }
  bool operator==(const DicomPixels&) const = default;
};

/// Colour table of one channel.
struct DicomTable {
  std::int32_t first = 0;  // value of the first entry
  std::vector<std::uint8_t> entries;
};

/// One frame, with its place and the meaning of its values.
struct DicomPlane {
  std::uint32_t file = 0, frame = 0;
  std::optional<glm::dvec3> position;  // centre of the first pixel in mm: left, posterior, superior (LPS)
  bool oriented = false;
  glm::dvec3 row{1, 0, 0}, column{0, 1, 0};  // directions of rising column and row numbers
  glm::dvec2 spacing{1, 1};                  // of columns and rows in mm
  bool spaced = false;                       // `spacing` is in mm, not only a ratio
  double between = 0;                        // distance of slices in mm; 0 if unknown
  double slope = 1, intercept = 0;
  std::uint32_t instance = 0, acquisition = 0, temporal = 0, segment = 0;
  double time = NAN;  // seconds
  double b_value = NAN;
  std::string kind;  // frames of different kinds, such as phase and magnitude, are different volumes
};

/// Facts of one file. None of them is about the patient; `series` only separates series.
struct DicomImage {
  std::string name;    // of the file
  std::string series;  // UID
  std::string modality;
  std::uint32_t series_number = 0;
  DicomPixels pixels;
  DicomSegments segments = DicomSegments::none;
  std::vector<DicomTable> palette;                  // red, green, blue
  std::string unit;                                 // of values; empty if unknown
  std::optional<double> missing;                    // stored value outside of the field of view
  std::optional<std::pair<double, double>> window;  // centre and width
  bool moving = false;                              // frames follow each other in time
  std::vector<DicomPlane> planes;
};

/// Returns the facts of a file. Returns a message if it has no image, or pixels are missing.
[[nodiscard]] std::variant<DicomImage, std::string> read_dicom_image(const DicomFile& file, std::string name);

}  // namespace gs::app

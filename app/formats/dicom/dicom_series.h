#pragma once

#include "app/formats/dicom/dicom_image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Slice of a volume: a plane, or a mixture of two. Segmentations may have several planes at a place.
struct DicomSlice {
  std::vector<std::uint32_t> planes;  // indices of DicomSeries::planes; none if the slice is missing
  double share = 0;                   // of the second plane, if the slice mixes two
};

/// Volume of a series, or a time series of volumes.
struct DicomSeries {
  std::string path;       // "CT-3": modality and number of the series
  std::size_t image = 0;  // index of the first file, for the facts that all of its files share
  std::vector<DicomPlane> planes;
  std::vector<std::vector<DicomSlice>> steps;  // the slices of each step, all steps of the same length
  std::vector<double> times;                   // of the steps
  std::array<glm::dvec3, 3> axes{};            // from a voxel to the next, mm
  glm::dvec3 origin{0};
  std::vector<std::string> notes;
  std::size_t missing = 0;  // slices
  bool placed = false;      // the place in the patient is known

  [[nodiscard]] std::size_t slices() const { return steps.empty() ? 0 : steps.front().size(); }
};

/// Returns a number with at most three digits behind the point.
[[nodiscard]] std::string dicom_number_text(double value);

/// Separates frames into volumes: by series, kind, orientation, size and spacing. Sorts the slices of each by position,
/// and several images of a place by time. The largest volume comes first.
[[nodiscard]] std::vector<DicomSeries> dicom_series(std::span<const DicomImage> images);

}  // namespace gs::app

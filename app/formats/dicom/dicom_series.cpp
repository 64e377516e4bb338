#include "app/formats/dicom/dicom_series.h"

#include "qnv/container/step_table.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace gs::app {
namespace {

using Planes = std::vector<std::uint32_t>;  // indices

/// Reports whether two frames may be slices of one volume.
bool same_volume(const DicomImage& image, const DicomPlane& plane, const DicomImage& other, const DicomPlane& one) {
  constexpr double kTurn = 1e-3, kScale = 1e-3;
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < kTurn; };
  DicomPixels pixels = image.pixels;
  pixels.frames = other.pixels.frames;
  return image.series == other.series && plane.kind == one.kind && pixels == other.pixels &&
         image.segments == other.segments && image.moving == other.moving && plane.oriented == one.oriented &&
         near(plane.row, one.row) && near(plane.column, one.column) &&
         glm::distance(plane.spacing, one.spacing) <= kScale * glm::length(plane.spacing);
}

glm::dvec3 normal_of(const DicomPlane& plane) { return glm::cross(plane.row, plane.column); }

/// Places of slices along the normal, each with its planes.
struct DicomPlace {
  double along = 0;
  Planes planes;
};

std::vector<DicomPlace> places_of(const DicomSeries& series) {
  Planes order(series.planes.size());
  std::iota(order.begin(), order.end(), 0u);
  const glm::dvec3 normal = normal_of(series.planes.front());
  const bool placed = std::ranges::all_of(series.planes, [](const auto& p) { return p.position.has_value(); });
  const auto number = [&](std::uint32_t i) {
    const DicomPlane& plane = series.planes[i];
    return std::tuple(plane.instance, plane.file, plane.frame);
  };
  std::vector<DicomPlace> places;
  if (!placed) {
    std::ranges::sort(order, {}, number);
    const double between = series.planes.front().between > 0 ? series.planes.front().between : 1;
    for (const std::uint32_t i : order) places.push_back({between * static_cast<double>(places.size()), {i}});
    return places;
  }
  std::vector<double> along;
  for (const DicomPlane& plane : series.planes) along.push_back(glm::dot(*plane.position, normal));
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::tuple(along[i], number(i)); });
  constexpr double kSame = 1e-2;  // mm
  for (const std::uint32_t i : order) {
    if (places.empty() || along[i] - places.back().along > kSame) places.push_back({along[i], {}});
    places.back().planes.push_back(i);
  }
  return places;
}

/// Sorts the images of a place by time, and removes copies. Returns the number of copies.
std::size_t order_in_time(const DicomSeries& series, Planes& planes) {
  const auto key = [&](std::uint32_t i) {
    const DicomPlane& plane = series.planes[i];
    const auto known = [](double value) { return std::isnan(value) ? 0 : value; };
    // Without a number, different files are different images.
    return std::tuple(plane.temporal, known(plane.b_value), known(plane.time), plane.acquisition, plane.instance,
                      plane.frame, plane.segment, plane.instance == 0 ? plane.file : 0);
  };
  std::ranges::sort(planes, {}, key);
  const auto same = [&](std::uint32_t a, std::uint32_t b) { return key(a) == key(b); };
  const auto copies = std::unique(planes.begin(), planes.end(), same);
  const auto removed = static_cast<std::size_t>(planes.end() - copies);
  planes.erase(copies, planes.end());
  return removed;
}

/// Divides the images of all places into steps. Result: for each step, the plane of each place, or kNoPlane.
constexpr std::uint32_t kNoPlane = 0xffffffff;
std::vector<Planes> divide(const DicomSeries& series, std::vector<DicomPlace>& places,
                           std::vector<std::string>& notes) {
  std::size_t copies = 0;
  std::map<std::size_t, std::size_t> sizes;
  for (DicomPlace& place : places) {
    copies += order_in_time(series, place.planes);
    ++sizes[place.planes.size()];
  }
  if (copies > 0) notes.push_back(std::to_string(copies) + " images are copies of others");
  // Numbers of times that differ within each place say to which step an image belongs.
  std::set<std::uint32_t> numbers;
  bool numbered = sizes.rbegin()->first > 1;
  for (const DicomPlace& place : places)
    for (std::size_t i = 0; i < place.planes.size(); ++i) {
      const std::uint32_t number = series.planes[place.planes[i]].temporal;
      numbered = numbered && number > 0 && (i == 0 || number != series.planes[place.planes[i - 1]].temporal);
      numbers.insert(number);
    }
  if (numbered) {
    std::vector<Planes> steps;
    for (const std::uint32_t number : numbers) {
      Planes& step = steps.emplace_back(places.size(), kNoPlane);
      for (std::size_t i = 0; i < places.size(); ++i)
        for (const std::uint32_t plane : places[i].planes)
          if (series.planes[plane].temporal == number) step[i] = plane;
    }
    return steps;
  }
  const std::size_t count =
      std::ranges::max_element(sizes, {}, [](const auto& size) { return std::pair(size.second, size.first); })->first;
  std::vector<Planes> steps(count, Planes(places.size(), kNoPlane));
  std::size_t extra = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Planes& planes = places[i].planes;
    extra += planes.size() > count ? planes.size() - count : 0;
    for (std::size_t k = 0; k < std::min(planes.size(), count); ++k) steps[k][i] = planes[k];
  }
  if (extra > 0)
    notes.push_back(std::to_string(extra) + (extra == 1 ? " image was" : " images were") +
                    " left out, because other places have fewer");
  return steps;
}

std::string millimetres(double value) { return dicom_number_text(value) + " mm"; }

/// DicomPlace of each slice of the regular grid among the places of the images.
struct GridSlice {
  std::size_t place = 0;
  double share = 0;      // of the next place
  bool missing = false;  // no image lies there
};

/// Makes a regular grid of the places. Slices that lack are missing; unequal distances are mixed from two slices.
std::vector<GridSlice> regular(const std::vector<DicomPlace>& places, double stated, DicomSeries& series) {
  std::vector<GridSlice> grid;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < places.size(); ++i) gaps.push_back(places[i].along - places[i - 1].along);
  if (gaps.empty()) return {GridSlice{}};
  std::vector<double> sorted = gaps;
  std::ranges::sort(sorted);
  double step = sorted[sorted.size() / 2];
  // Frames of a segmentation are only where something was found.
  if (stated > 0 && stated < sorted.front() * 1.05) step = stated;
  constexpr double kTolerance = 0.1;  // of a step
  const std::size_t most = 4 * places.size() + 16;
  bool fits = true;
  std::size_t count = 1;
  for (const double gap : gaps) {
    const double steps = std::round(gap / step);
    fits =
        fits && steps >= 1 && std::abs(gap / step - steps) <= kTolerance * steps && steps < static_cast<double>(most);
    if (fits) count += static_cast<std::size_t>(steps);
  }
  if (fits && count <= most) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i > 0) {
        const auto steps = static_cast<std::size_t>(std::round(gaps[i - 1] / step));
        for (std::size_t k = 1; k < steps; ++k) grid.push_back({i - 1, 0, true});
      }
      grid.push_back({i, 0, false});
    }
    return grid;
  }
  const double whole = places.back().along - places.front().along;
  count = static_cast<std::size_t>(std::min(std::ceil(whole / sorted.front()) + 1, static_cast<double>(most)));
  count = std::max<std::size_t>(count, 2);
  series.notes.push_back("slices are " + millimetres(sorted.front()) + " to " + millimetres(sorted.back()) +
                         " apart; mixed to slices of " + millimetres(whole / static_cast<double>(count - 1)));
  std::size_t place = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = places.front().along + whole * static_cast<double>(i) / static_cast<double>(count - 1);
    while (place + 2 < places.size() && places[place + 1].along <= along) ++place;
    const double gap = places[place + 1].along - places[place].along;
    grid.push_back({place, std::clamp((along - places[place].along) / gap, 0.0, 1.0), false});
  }
  return grid;
}

/// Sets the axes and the origin of the grid.
void place_grid(DicomSeries& series, const std::vector<DicomPlace>& places, std::size_t slices) {
  const DicomPlane& first = series.planes[places.front().planes.front()];
  const DicomPlane& last = series.planes[places.back().planes.front()];
  series.axes[0] = first.row * first.spacing.x;
  series.axes[1] = first.column * first.spacing.y;
  const double thickness = first.between > 0 ? first.between : first.spacing.x;
  series.axes[2] = normal_of(first) * (slices > 1 && first.between <= 0 && !first.position ? 1.0 : thickness);
  series.placed = first.oriented && first.position.has_value();
  if (!first.position) return;
  series.origin = *first.position;
  // The gantry may be tilted, so that the slices are not above each other.
  if (slices > 1 && last.position)
    series.axes[2] = (*last.position - *first.position) / static_cast<double>(slices - 1);
}

void set_times(DicomSeries& series) {
  bool rising = true;
  for (const auto& step : series.steps) {
    double time = NAN;
    for (const DicomSlice& slice : step)
      if (!slice.planes.empty() && std::isnan(time)) time = series.planes[slice.planes.front()].time;
    rising = rising && !std::isnan(time) && (series.times.empty() || time > series.times.back());
    series.times.push_back(time);
  }
  const double begin = rising && !series.times.empty() ? series.times.front() : 0;
  for (std::size_t i = 0; i < series.times.size(); ++i)
    series.times[i] = rising ? series.times[i] - begin : static_cast<double>(i);
}

/// Arranges the planes of a series in slices and steps.
void arrange(DicomSeries& series, const DicomImage& image) {
  if (image.moving) {
    for (std::uint32_t i = 0; i < series.planes.size(); ++i) series.steps.push_back({DicomSlice{{i}, 0}});
    place_grid(series, {{0, {0}}}, 1);
    set_times(series);
    return;
  }
  std::vector<DicomPlace> places = places_of(series);
  const bool segments = image.segments == DicomSegments::binary;
  const std::vector<GridSlice> grid = regular(places, segments ? series.planes.front().between : 0, series);
  std::vector<Planes> steps;
  if (segments) {
    std::size_t copies = 0;
    for (DicomPlace& place : places) copies += order_in_time(series, place.planes);
    if (copies > 0) series.notes.push_back(std::to_string(copies) + " images are copies of others");
    steps.emplace_back(places.size(), 0u);
  } else {
    steps = divide(series, places, series.notes);
  }
  if (steps.size() > qnv::kMaxSteps) {
    series.notes.push_back("only the first " + std::to_string(qnv::kMaxSteps) + " of " + std::to_string(steps.size()) +
                           " steps are shown");
    steps.resize(qnv::kMaxSteps);
  }
  for (const Planes& planes : steps) {
    std::vector<DicomSlice>& slices = series.steps.emplace_back();
    for (const GridSlice& at : grid) {
      DicomSlice slice;
      if (segments && !at.missing) {
        slice.planes = places[at.share > 0.5 ? at.place + 1 : at.place].planes;
      } else if (!at.missing && planes[at.place] != kNoPlane) {
        slice.planes = {planes[at.place]};
        if (at.share > 0 && planes[at.place + 1] != kNoPlane) {
          slice.planes.push_back(planes[at.place + 1]);
          slice.share = at.share;
        }
      }
      if (slice.planes.empty() && !segments) ++series.missing;
      slices.push_back(std::move(slice));
    }
  }
  if (series.missing > 0)
    series.notes.push_back(std::to_string(series.missing) + (series.missing == 1 ? " slice is" : " slices are") +
                           " missing");
  place_grid(series, places, grid.size());
  set_times(series);
}

}  // namespace

std::string dicom_number_text(double value) {
  std::string text = std::to_string(std::round(value * 1000) / 1000);
  while (text.ends_with('0')) text.pop_back();
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::vector<DicomSeries> dicom_series(std::span<const DicomImage> images) {
  std::vector<DicomSeries> all;
  // Series in which a frame was seen last: neighbours are in the same one.
  std::map<std::string, std::vector<std::size_t>> by_series;
  for (std::size_t i = 0; i < images.size(); ++i)
    for (const DicomPlane& plane : images[i].planes) {
      std::vector<std::size_t>& candidates = by_series[images[i].series];
      const auto found = std::ranges::find_if(candidates, [&](std::size_t candidate) {
        return same_volume(images[all[candidate].image], all[candidate].planes.front(), images[i], plane);
      });
      constexpr std::size_t kMostSeries = 4096;
      if (found == candidates.end() && all.size() >= kMostSeries) continue;
      std::size_t at = all.size();
      if (found == candidates.end()) {
        candidates.push_back(at);
        all.emplace_back().image = i;
      } else {
        at = *found;
      }
      all[at].planes.push_back(plane);
      all[at].planes.back().file = static_cast<std::uint32_t>(i);
    }
  for (DicomSeries& series : all) arrange(series, images[series.image]);
  std::ranges::stable_sort(all, std::ranges::greater(), [&](const DicomSeries& series) {
    const DicomPixels& pixels = images[series.image].pixels;
    // A volume comes before pictures of more pixels.
    return std::pair(series.slices() > 1, series.planes.size() * std::uint64_t{pixels.rows} * pixels.columns);
  });
  std::map<std::string, int> names;
  for (DicomSeries& series : all) {
    const DicomImage& image = images[series.image];
    series.path = (image.modality.empty() ? "series" : image.modality) + '-' + std::to_string(image.series_number);
    if (const int number = ++names[series.path]; number > 1) series.path += '.' + std::to_string(number);
  }
  return all;
}

}  // namespace gs::app

#include "app/formats/flow/flow_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

/// Tracer of the lines of a field. Places are in distances of stored vectors.
class StreamlineTracer {
 public:
  StreamlineTracer(const VectorField& field, const StreamlineOptions& options) : field_(field), options_(options) {
    constexpr double kUsual = 0.9, kVanishing = 1e-4;
    least_length_ = field.length_at(kUsual) * kVanishing;
    for (std::size_t i = 0; i < 3; ++i) {
      cells_[i] = (field.size()[i] - 1) / kCell + 1;
      most_steps_ = std::max(most_steps_, field.size()[i]);
    }
    most_steps_ = static_cast<std::uint32_t>(std::min(3 * most_steps_ / options.step, 20'000.0));
    used_.resize(std::size_t{cells_[0]} * cells_[1] * cells_[2]);
  }

  std::vector<Streamline> run() {
    const double volume = static_cast<double>(field_.size()[0]) * field_.size()[1] * field_.size()[2];
    const std::size_t wide = static_cast<std::size_t>(
        std::count_if(field_.size().begin(), field_.size().end(), [](std::uint32_t size) { return size > 1; }));
    const double apart = std::max(1.0, std::pow(volume / static_cast<double>(options_.seeds),
                                                1.0 / static_cast<double>(std::max<std::size_t>(wide, 1))));
    std::vector<Streamline> lines;
    std::array<std::vector<double>, 3> places;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto count = static_cast<std::size_t>(std::max(1.0, std::round(field_.size()[i] / apart)));
      for (std::size_t k = 0; k < count; ++k)
        places[i].push_back((static_cast<double>(k) + 0.5) / static_cast<double>(count) *
                            static_cast<double>(field_.size()[i] - 1));
    }
    std::vector<glm::dvec3> seeds;
    for (const double z : places[2])
      for (const double y : places[1])
        for (const double x : places[0]) seeds.emplace_back(x, y, z);
    // A stride that is prime to the count spreads the seeds, so that a limit of points cuts the density, not a corner.
    const std::size_t stride = seeds.size() % 7 != 0 ? 7 : seeds.size() % 11 != 0 ? 11 : 13;
    for (std::size_t i = 0; i < seeds.size() && points_ < options_.most_points; ++i) {
      const glm::dvec3& seed = seeds[i * stride % seeds.size()];
      if (used_[cell_of(seed)]) continue;
      Streamline line = through(seed);
      constexpr std::size_t kLeastPoints = 3;
      if (line.points.size() < kLeastPoints) continue;
      points_ += line.points.size();
      lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  static constexpr std::uint32_t kCell = 2;  // stored vectors along an edge of a cell that one line may fill

  [[nodiscard]] std::size_t cell_of(const glm::dvec3& place) const {
    std::array<std::size_t, 3> cell{};
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      cell[axis] = std::min(static_cast<std::size_t>(std::max(place[i], 0.0)) / kCell, std::size_t{cells_[axis]} - 1);
    }
    return (cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0];
  }

  /// Returns the direction of the flow, one distance of stored vectors long; nullopt where the line ends.
  [[nodiscard]] std::optional<glm::dvec3> direction(const glm::dvec3& place) const {
    const auto vector = field_.interpolated(place);
    if (!vector || !(glm::length(*vector) > least_length_)) return std::nullopt;
    const glm::dvec3 steps = field_.in_steps(*vector);
    const double length = glm::length(steps);
    return length > 0 ? std::optional(steps / length) : std::nullopt;
  }

  /// Follows the flow from a seed, forwards or backwards.
  void follow(glm::dvec3 place, double step, Streamline& line) {
    std::vector<std::size_t> own;
    for (std::uint32_t i = 0; i < most_steps_; ++i) {
      const auto k1 = direction(place);
      const auto k2 = k1 ? direction(place + *k1 * (step / 2)) : std::nullopt;
      const auto k3 = k2 ? direction(place + *k2 * (step / 2)) : std::nullopt;
      const auto k4 = k3 ? direction(place + *k3 * step) : std::nullopt;
      if (!k4) return;
      place += (*k1 + 2.0 * *k2 + 2.0 * *k3 + *k4) * (step / 6);
      const auto vector = field_.interpolated(place);
      if (!vector) return;
      line.points.push_back(field_.position(place));
      line.vectors.push_back(*vector);
      const std::size_t cell = cell_of(place);
      // A line that returns to its own cells is circling.
      if (own.empty() || own.back() != cell) {
        if (std::ranges::count(own, cell) >= 2) return;
        own.push_back(cell);
        used_[cell] = true;
      }
    }
  }

  Streamline through(const glm::dvec3& seed) {
    Streamline line;
    const auto vector = field_.interpolated(seed);
    if (!vector) return line;
    follow(seed, -options_.step, line);
    std::ranges::reverse(line.points);
    std::ranges::reverse(line.vectors);
    line.points.push_back(field_.position(seed));
    line.vectors.push_back(*vector);
    used_[cell_of(seed)] = true;
    follow(seed, options_.step, line);
    return line;
  }

  const VectorField& field_;
  StreamlineOptions options_;
  double least_length_ = 0;
  std::array<std::uint32_t, 3> cells_{};
  std::vector<bool> used_;
  std::uint32_t most_steps_ = 1;
  std::size_t points_ = 0;
};

}  // namespace

std::vector<Streamline> streamlines_of(const VectorField& field, const StreamlineOptions& options) {
  return StreamlineTracer(field, options).run();
}

}  // namespace gs::app

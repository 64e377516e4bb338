#include "app/formats/datasets/conventions/mesh_arrays.h"

#include "base/text.h"

#include <algorithm>

namespace gs::app {

void append_values(std::span<const double> numbers, std::size_t parts, const VoxelComponent& choice,
                   PolyData::Data& data) {
  if (parts == 0) return;
  data.values.reserve(data.values.size() + numbers.size() / parts);
  for (std::size_t i = 0; i + parts <= numbers.size(); i += parts)
    append_number(numbers.subspan(i, parts), choice, data);
}

void set_title(std::string_view name, std::size_t parts, std::string_view unit, const VoxelComponent& choice,
               PolyData::Data& data) {
  if (choice.found) choice.found->components = std::max<std::size_t>(parts, 1);
  data.title = shortened(name, 80) + part_text(parts, choice);
  if (!unit.empty()) data.title += " (" + shortened(unit, 40) + ")";
}

void append_points(std::span<const double> numbers, std::size_t parts, std::vector<glm::vec3>& points) {
  if (parts == 0 || parts > 3) return;
  points.reserve(points.size() + numbers.size() / parts);
  for (std::size_t i = 0; i + parts <= numbers.size(); i += parts) {
    glm::vec3 point(0);
    for (std::size_t k = 0; k < parts; ++k) point[static_cast<int>(k)] = static_cast<float>(numbers[i + k]);
    points.push_back(point);
  }
}

std::int32_t index_below(double number, std::size_t count) {
  return number >= 0 && number < static_cast<double>(std::min<std::size_t>(count, kBadIndex))
             ? static_cast<std::int32_t>(number)
             : kBadIndex;
}

}  // namespace gs::app

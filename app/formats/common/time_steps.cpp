#include "app/formats/common/time_steps.h"

#include "app/formats/common/scene_builder.h"
#include "app/formats/common/text_cursor.h"
#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

constexpr std::string_view kTimeStepsMark = "time steps:";

std::optional<TimeSteps> read_time_steps(std::string_view text) {
  if (!text.starts_with(kTimeStepsMark)) return std::nullopt;
  text.remove_prefix(kTimeStepsMark.size());
  TextCursor cursor(text.data(), text.data() + text.size());
  TimeSteps steps;
  double shown = 0, time = 0;
  if (!cursor.skip_space() || !cursor.number(shown) || !(shown >= 0 && shown < kMaxTimeSteps)) return std::nullopt;
  steps.shown = static_cast<std::size_t>(shown);
  while (cursor.skip_space() && steps.times.size() <= kMaxTimeSteps) {
    if (!cursor.number(time)) return std::nullopt;
    steps.times.push_back(time);
  }
  return is_valid(steps) ? std::optional(std::move(steps)) : std::nullopt;
}

}  // namespace

bool is_valid(const TimeSteps& steps) {
  return steps.times.size() >= 2 && steps.times.size() <= kMaxTimeSteps && steps.shown < steps.times.size() &&
         std::ranges::all_of(steps.times, [](double time) { return std::isfinite(time); });
}

void add_time_steps(SceneBuilder& builder, const TimeSteps& steps) {
  if (!is_valid(steps)) return;
  std::string text = std::string(kTimeStepsMark) + ' ' + std::to_string(steps.shown);
  for (const double time : steps.times) {
    char number[32];
    const auto end = std::to_chars(number, number + sizeof number, time);
    text += ' ';
    text.append(number, end.ptr);
  }
  const vrml::NodeId info = builder.make(vrml::NodeKind::world_info);
  vrml::MFString lines;
  lines.push_back(std::move(text));
  builder.set<vrml::MFString>(info, "info", std::move(lines));
  builder.add_root(info);
}

std::optional<TimeSteps> time_steps_of(const vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    if (node.in_prototype_body || node.type->read_as != vrml::NodeKind::world_info) continue;
    for (const vrml::String& line : scene.get<vrml::MFString>(scene.nodes().id_at(i), "info"))
      if (auto steps = read_time_steps(line.str())) return steps;
  }
  return std::nullopt;
}

}  // namespace gs::app

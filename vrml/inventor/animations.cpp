#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"
#include "vrml/scene/values/transformation.h"

#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <numbers>

// Rotor, Pendulum, Shuttle and Blinker: nodes that move, and links that pass the point of the click.
namespace gs::vrml::inventor {
namespace {

constexpr int kSwingSamples = 17;  // of one cycle that follows a cosine

/// Adds a TimeSensor that repeats `cycles` times a second, and returns its name.
std::string add_clock(Converter& converter, const Item& item, NodeTarget target, float cycles) {
  Output& output = converter.output();
  std::string name = converter.unique_name("Clock");
  const NodeId clock = output.begin("TimeSensor", target, item.location, name);
  if (!clock) return {};
  output.set(clock, "cycleInterval", SFTime{1.0 / static_cast<double>(cycles)});
  output.set(clock, "loop", true);
  output.end(clock);
  return name;
}

/// Adds an interpolator that drives a field of the node `moved` over each cycle of a new TimeSensor.
template <class Values>
void animate(Converter& converter, const Item& item, std::string_view type, const Values& values,
             const std::string& moved, const char* event_in) {
  const float speed = std::abs(item.get<SFFloat>("speed"));
  Output& output = converter.output();
  const auto target = output.group_target();
  if (!item.get<SFBool>("on") || !(speed > 0) || !std::isfinite(speed) || !target) return;
  const std::string clock = add_clock(converter, item, *target, speed);
  const std::string path = converter.unique_name("Path");
  const NodeId node = clock.empty() ? NodeId{} : output.begin(type, *target, item.location, path);
  if (!node) return;
  MFFloat keys;
  for (std::size_t i = 0; i < values.size(); ++i)
    keys.push_back(static_cast<float>(i) / static_cast<float>(values.size() - 1));
  output.set(node, "key", keys);
  output.set(node, "keyValue", values);
  output.end(node);
  output.route({clock, "fraction_changed", path, "set_fraction", item.location});
  output.route({path, "value_changed", moved, event_in, item.location});
}

// Position in a swing from 0 to 1 and back, for a part of the cycle.
float swing(int sample) {
  const float turn = 2 * std::numbers::pi_v<float> * static_cast<float>(sample) / (kSwingSamples - 1);
  return (1 - std::cos(turn)) / 2;
}

void apply_rotor(Converter& converter, const Item& item) {
  const SFRotation start = item.get<SFRotation>("rotation");
  TransformFields fields;
  fields.rotation = start;
  const std::string name = converter.output().add_moving_transform(fields, converter.unique_name("Rotor"));
  if (name.empty()) return;
  MFRotation values;
  const float direction = item.get<SFFloat>("speed") < 0 ? -1 : 1;
  for (int third = 0; third <= 3; ++third) {
    SFRotation rotation = start;
    rotation.angle += direction * 2 * std::numbers::pi_v<float> * static_cast<float>(third) / 3;
    values.push_back(rotation);
  }
  animate(converter, item, "OrientationInterpolator", values, name, "set_rotation");
}

void apply_pendulum(Converter& converter, const Item& item) {
  const SFRotation from = item.get<SFRotation>("rotation0"), to = item.get<SFRotation>("rotation1");
  TransformFields fields;
  fields.rotation = from;
  const std::string name = converter.output().add_moving_transform(fields, converter.unique_name("Pendulum"));
  if (name.empty()) return;
  const glm::dquat first(rotation_matrix(from)), last(rotation_matrix(to));
  MFRotation values;
  for (int i = 0; i < kSwingSamples; ++i)
    values.push_back(rotation_of(glm::mat3_cast(glm::slerp(first, last, static_cast<double>(swing(i))))));
  animate(converter, item, "OrientationInterpolator", values, name, "set_rotation");
}

void apply_shuttle(Converter& converter, const Item& item) {
  const SFVec3f from = item.get<SFVec3f>("translation0"), to = item.get<SFVec3f>("translation1");
  TransformFields fields;
  fields.translation = from;
  const std::string name = converter.output().add_moving_transform(fields, converter.unique_name("Shuttle"));
  if (name.empty()) return;
  MFVec3f values;
  for (int i = 0; i < kSwingSamples; ++i) values.push_back(from + (to - from) * swing(i));
  animate(converter, item, "PositionInterpolator", values, name, "set_translation");
}

// Becomes a Switch, and a Script that chooses a child by the time.
void apply_blinker(Converter& converter, const Item& item) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target || item.children.empty()) return;
  const std::string name = converter.unique_name("Blinker");
  const NodeId node = output.begin("Switch", *target, item.location, name);
  if (!node) return;
  const std::int32_t which = std::max(item.get<SFInt32>("whichChild"), 0);
  const bool single = item.children.size() == 1;
  output.set(node, "whichChoice", SFInt32{which});
  output.end(node);
  output.note_shape();
  for (const ItemPtr& child : item.children)
    if (!converter.visit_alone(*child, output.field(node, "choice"))) return;
  const float speed = std::abs(item.get<SFFloat>("speed"));
  if (!item.get<SFBool>("on") || !(speed > 0) || !std::isfinite(speed)) return;
  const std::string clock = add_clock(converter, item, *target, speed);
  const std::string chooser = converter.unique_name("Choice");
  // A single child blinks: it is shown in the first half of each cycle.
  const std::string code = "javascript: function part(value) { choice = " +
                           (single ? std::string("value < 0.5 ? 0 : -1")
                                   : "Math.floor(value * " + std::to_string(item.children.size()) + ") % " +
                                         std::to_string(item.children.size())) +
                           "; }";
  if (clock.empty() || !output.add_script(chooser, code,
                                          {{AccessType::eventIn, FieldType::SFFloat, "part"},
                                           {AccessType::eventOut, FieldType::SFInt32, "choice"}},
                                          *target, item.location))
    return;
  output.route({clock, "fraction_changed", chooser, "part", item.location});
  output.route({chooser, "choice", name, "set_whichChoice", item.location});
}

// A click on the children of a WWWAnchor with `map POINT` adds the point to the url. VRML97 has no such Anchor: a
// Script opens the url.
void apply_point_anchor(Converter& converter, const Item& item) {
  Output& output = converter.output();
  const NodeId group = output.make_group("Group");
  if (!group) return;
  const std::string touch = converter.unique_name("Touch"), script = converter.unique_name("Link");
  const NodeTarget target = output.field(group, "children");
  if (!output.make("TouchSensor", target, item.location, touch)) return;
  std::string url;  // as a string of ECMAScript
  for (const char c : item.get<SFString>("name").view()) {
    if (c == '\\' || c == '\'') url += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) url += c;
  }
  const std::string code =
      "javascript: var at = null; function point(value) { at = new SFVec3f(value[0], value[1], value[2]); } function "
      "touched() { if (at) Browser.loadURL(new MFString('" +
      url + "?' + at[0] + ',' + at[1] + ',' + at[2]), new MFString()); }";
  if (output.add_script(
          script, code,
          {{AccessType::eventIn, FieldType::SFVec3f, "point"}, {AccessType::eventIn, FieldType::SFTime, "touched"}},
          target, item.location)) {
    output.route({touch, "hitPoint_changed", script, "point", item.location});
    output.route({touch, "touchTime", script, "touched", item.location});
  }
  converter.visit_children(item);
}

void apply_anchor(Converter& converter, const Item& item) {
  if (item.word("map") == "POINT") return apply_point_anchor(converter, item);
  Output& output = converter.output();
  const NodeId anchor = output.make_group("Anchor");
  if (!anchor) return;
  const String& url = item.get<SFString>("name");
  if (!url.empty()) output.set(anchor, "url", MFString{url});
  output.set(anchor, "description", item.get<SFString>("description"));
  converter.visit_children(item);
}

constexpr ItemRow kAnimationRows[] = {
    {"Rotor", ItemClass::plain, false, apply_rotor, "SFRotation rotation 0 0 1 0 SFFloat speed 1 SFBool on TRUE"},
    {"Pendulum", ItemClass::plain, false, apply_pendulum,
     "SFRotation rotation 0 0 1 0 SFRotation rotation0 0 0 1 0 SFRotation rotation1 0 0 1 0 SFFloat speed 1 SFBool on "
     "TRUE"},
    {"Shuttle", ItemClass::plain, false, apply_shuttle,
     "SFVec3f translation 0 0 0 SFVec3f translation0 0 0 0 SFVec3f translation1 0 0 0 SFFloat speed 1 SFBool on TRUE"},
    {"Blinker", ItemClass::group, false, apply_blinker, "SFInt32 whichChild -1 SFFloat speed 1 SFBool on TRUE"},
    {"WWWAnchor", ItemClass::group, true, apply_anchor, R"(
  SFString name ""
  SFString description ""
  SFEnum map NONE
  SFEnum renderCaching AUTO
  SFEnum boundingBoxCaching AUTO
  SFEnum renderCulling AUTO
  SFEnum pickCulling AUTO)"},
};

}  // namespace

std::span<const ItemRow> animation_rows() { return kAnimationRows; }

}  // namespace gs::vrml::inventor

#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

// Grouping nodes, levels of detail, files and links.
namespace gs::vrml::inventor {
namespace {

constexpr std::size_t kMaxCopies = 100'000;  // copies that Array and MultipleCopy make in total for one node

void apply_transform_separator(Converter& converter, const Item& item) {
  converter.output().save_transforms();
  converter.visit_children(item);
  converter.output().restore_transforms();
}

bool is_camera(const Item& item) { return item.type->find("focalDistance") != nullptr; }

// Reports whether a node leaves the state as it is, so that it may be one of the choices of a Switch.
bool keeps_state(const Item& item) { return item.type->keeps_state || item.type->kind == ItemClass::shape; }

// If all choices of a Switch keep the state, it becomes a Switch. Otherwise only the chosen child is converted, because
// it sets the state for later nodes. All cameras become Viewpoints: a Switch is how files offer several of them.
void apply_switch(Converter& converter, const Item& item) {
  const std::int32_t which = item.get<SFInt32>("whichChild");
  const auto chosen = [&](std::size_t i) { return which == -3 || static_cast<std::int64_t>(i) == which; };
  const bool cameras =
      std::any_of(item.children.begin(), item.children.end(), [](const ItemPtr& child) { return is_camera(*child); });
  const bool separate =
      std::all_of(item.children.begin(), item.children.end(), [](const ItemPtr& child) { return keeps_state(*child); });
  if (which >= 0 && separate && item.children.size() > 1 && static_cast<std::size_t>(which) < item.children.size()) {
    Output& output = converter.output();
    const auto target = output.target();
    if (!target) return;
    const NodeId node = output.begin("Switch", *target, item.location, item.name);
    if (!node) return;
    output.set(node, "whichChoice", SFInt32{which});
    output.end(node);
    output.note_shape();
    for (const ItemPtr& child : item.children)
      if (!converter.visit_alone(*child, output.field(node, "choice"))) return;
    return;
  }
  for (std::size_t i = 0; i < item.children.size(); ++i)
    if (chosen(i)) converter.visit(*item.children[i]);
  if (!cameras) return;
  for (std::size_t i = 0; i < item.children.size(); ++i)
    if (!chosen(i) && is_camera(*item.children[i])) converter.visit(*item.children[i]);
}

void apply_first_child(Converter& converter, const Item& item) {
  if (item.children.empty()) return;
  const std::int32_t which = std::max(item.get<SFInt32>("whichChild"), 0);
  const auto index = std::min(static_cast<std::size_t>(which), item.children.size() - 1);
  converter.visit(*item.children[index]);
}

void apply_lod(Converter& converter, const Item& item) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const NodeId node = output.begin("LOD", *target, item.location, item.name);
  if (!node) return;
  output.set(node, "center", item.get<SFVec3f>("center"));
  MFFloat ranges = item.get<MFFloat>("range");
  if (!item.children.empty() && ranges.size() >= item.children.size()) ranges.resize(item.children.size() - 1);
  output.set(node, "range", ranges);
  output.end(node);
  output.note_shape();
  for (const ItemPtr& child : item.children)
    if (!converter.visit_alone(*child, output.field(node, "level"))) return;
}

void apply_file(Converter& converter, const Item& item) {
  const String& url = item.get<SFString>("name");
  Output& output = converter.output();
  const auto target = url.empty() ? std::nullopt : output.target();
  if (!target) return;
  const NodeId node = output.begin("Inline", *target, item.location, item.name);
  if (!node) return;
  output.set(node, "url", MFString{url});
  if (item.type->find("bboxSize")) {
    const SFVec3f size = item.get<SFVec3f>("bboxSize");
    if (size.x > 0 || size.y > 0 || size.z > 0) {
      output.set(node, "bboxSize", size);
      output.set(node, "bboxCenter", item.get<SFVec3f>("bboxCenter"));
    }
  }
  output.end(node);
  output.note_shape();
}

/// Transforms of copies. With several lists, each list copies all copies of the next list together.
using Places = std::vector<std::vector<Operation>>;

// Adds the children once per matrix. The first copy is converted, the others use it.
void add_copies(Converter& converter, const Item& item, std::span<const std::vector<Operation>> places) {
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  NodeId content;
  for (const Operation& place : places.front()) {
    if (!converter.may_go_on(item.location)) return;
    const NodeId node = output.begin("Transform", *target, item.location);
    if (!node) return;
    bool inexact = false;
    const TransformFields fields = merge(std::span(&place, 1), inexact);
    output.set(node, "translation", fields.translation);
    output.set(node, "rotation", fields.rotation);
    output.set(node, "scale", fields.scale);
    output.set(node, "scaleOrientation", fields.scale_orientation);
    output.end(node);
    if (content) {
      output.place(content, output.field(node, "children"));
      continue;
    }
    converter.push_state();
    content = output.open_group_in(output.field(node, "children"), "Group", item.location);
    if (content && places.size() > 1)
      add_copies(converter, item, places.subspan(1));
    else if (content)
      converter.visit_children(item);
    output.close_group();
    converter.pop_state();
    if (!content) return;
  }
  output.note_shape();
}

void apply_array(Converter& converter, const Item& item) {
  std::int64_t numbers[3], total = 1;
  SFVec3f steps[3];
  for (int i = 0; i < 3; ++i) {
    const std::string digit = std::to_string(i + 1);
    numbers[i] = std::clamp<std::int64_t>(item.get<SFInt32>("numElements" + digit), 1, kMaxCopies);
    steps[i] = item.get<SFVec3f>("separation" + digit);
    total *= numbers[i];
    if (total > static_cast<std::int64_t>(kMaxCopies)) {
      converter.warn_once(item.location, "Array exceeds the limit of 100,000 elements; skipped the rest");
      numbers[i] = std::max<std::int64_t>(1, numbers[i] * static_cast<std::int64_t>(kMaxCopies) / total);
      total = static_cast<std::int64_t>(kMaxCopies);
    }
  }
  const std::string_view origin = item.word("origin");
  const float shift = origin == "CENTER" ? 0.5F : origin == "LAST" ? 1.0F : 0.0F;
  SFVec3f first(0);
  for (int i = 0; i < 3; ++i) first -= steps[i] * (shift * static_cast<float>(numbers[i] - 1));
  Places places;
  for (const int axis : {2, 1, 0}) {
    if (numbers[axis] == 1 && (axis > 0 || !places.empty())) continue;
    std::vector<Operation>& line = places.emplace_back();
    for (std::int64_t i = 0; i < numbers[axis]; ++i) {
      Operation place;
      place.fields.translation = steps[axis] * static_cast<float>(i);
      if (places.size() == 1) place.fields.translation += first;
      line.push_back(place);
    }
  }
  add_copies(converter, item, places);
}

void apply_multiple_copy(Converter& converter, const Item& item) {
  const MFFloat& numbers = item.get<MFFloat>("matrix");
  std::vector<Operation> places;
  for (std::size_t i = 0; i + 16 <= numbers.size() && places.size() < kMaxCopies; i += 16)
    places.push_back({{}, matrix_of(numbers, i)});
  add_copies(converter, item, std::span(&places, 1));
}

constexpr std::string_view kSeparatorFields = R"(
  SFEnum renderCaching AUTO
  SFEnum boundingBoxCaching AUTO
  SFEnum renderCulling AUTO
  SFEnum pickCulling AUTO)";

constexpr ItemRow kGroupRows[] = {
    {"Separator", ItemClass::group, true, apply_children, kSeparatorFields},
    {"Annotation", ItemClass::group, true, apply_children, kSeparatorFields},
    {"Selection ExtSelection LocateHighlight", ItemClass::group, true, apply_children, R"(
  SFEnum renderCaching AUTO
  SFEnum boundingBoxCaching AUTO
  SFEnum renderCulling AUTO
  SFEnum pickCulling AUTO
  SFEnum policy SHIFT
  SFEnum mode AUTO
  SFEnum style EMISSIVE
  SFColor color 0.3 0.3 0.3
  SFEnum lassoType NOLASSO
  SFEnum lassoPolicy FULL_BBOX
  SFEnum lassoMode ALL_SHAPES)"},
    {"Group ShadowGroup", ItemClass::group, false, apply_children},
    {"TransformSeparator", ItemClass::group, false, apply_transform_separator},
    {"Switch", ItemClass::group, false, apply_switch, "SFInt32 whichChild -1"},
    {"PathSwitch", ItemClass::group, false, nullptr, "SFPath path", "its children are not shown"},
    {"LevelOfDetail", ItemClass::group, false, apply_first_child, "MFFloat screenArea 0"},
    {"LOD", ItemClass::group, false, apply_lod, "MFFloat range [] SFVec3f center 0 0 0"},
    {"LevelOfSimplification LodSimplificationGroup", ItemClass::group, false, apply_first_child},
    {"WWWInline", ItemClass::group, false, apply_file,
     "SFString name \"\" SFVec3f bboxSize 0 0 0 SFVec3f bboxCenter 0 0 0 SFNode alternateRep"},
    {"File", ItemClass::plain, false, apply_file, "SFString name \"\""},
    {"Array", ItemClass::group, false, apply_array, R"(
  SFShort numElements1 1
  SFShort numElements2 1
  SFShort numElements3 1
  SFVec3f separation1 1 0 0
  SFVec3f separation2 0 1 0
  SFVec3f separation3 0 0 1
  SFEnum origin FIRST)"},
    {"MultipleCopy", ItemClass::group, false, apply_multiple_copy,
     "MFMatrix matrix [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]"},
};

}  // namespace

std::span<const ItemRow> group_rows() { return kGroupRows; }

}  // namespace gs::vrml::inventor

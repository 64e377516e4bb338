#include "vrml/inventor/converter.h"

#include <algorithm>

namespace gs::vrml::inventor {
namespace {

constexpr std::uint64_t kFreeVisits = 1'000'000;  // nodes that any text may apply; larger texts may apply more
constexpr std::uint64_t kVisitsPerNode = 16;
constexpr std::size_t kMaxMessages = 1000;
constexpr std::size_t kMaxConversions = 16;  // different conversions of one Separator that are kept

std::uint32_t bit(Part part) { return std::uint32_t{1} << static_cast<unsigned>(part); }

}  // namespace

void Converter::convert(const Item& item, std::uint64_t read_nodes) {
  max_visits_ = kFreeVisits + read_nodes * kVisitsPerNode;
  visit(item);
}

bool Converter::may_go_on(SourceLocation location) {
  if (sink_.scene().memory().exhausted()) {
    (void)sink_.limits().is_exhausted(location);
    return false;
  }
  return visits_ <= max_visits_ && !sink_.scene().budget()->stopped();
}

void Converter::visit(const Item& item) {
  if (!item.type->note.empty()) warn_once(item.location, item.type->name + ": " + std::string(item.type->note));
  if (++visits_ > max_visits_) {
    if (!std::exchange(said_work_, true))
      sink_.problems().error(
          item.location, "node uses exceed the limit of " + std::to_string(max_visits_) + "; skipped the remaining nodes");
    return;
  }
  if (visits_ % 256 == 0 && !may_go_on(item.location)) {
    max_visits_ = 0;
    said_work_ = true;
    return;
  }
  if (depth_ >= sink_.scene().limits().nesting) {
    if (!std::exchange(said_depth_, true))
      sink_.problems().error(item.location, "nodes are nested deeper than the limit of " + std::to_string(depth_) +
                                                "; skipped the deeper nodes");
    return;
  }
  ++depth_;
  if (!item.name.empty()) ++named_depth_;
  if (item.type->keeps_state)
    visit_scope(item);
  else if (item.type->apply)
    item.type->apply(*this, item);
  if (!item.name.empty()) --named_depth_;
  --depth_;
}

void Converter::visit_children(const Item& item) {
  for (const ItemPtr& child : item.children) visit(*child);
}

void Converter::visit_scope(const Item& item) {
  if (reuse(item)) return;
  push_state();
  output_.open_group(item.name, item.location);
  if (item.type->apply) item.type->apply(*this, item);
  Conversion conversion;
  conversion.has_shapes = output_.has_shapes();
  conversion.node = output_.close_group();
  if (item.name.empty()) return pop_state();
  pop_frame(&conversion);
  std::vector<Conversion>& kept = conversions_[item.serial];
  if (kept.size() < kMaxConversions) kept.push_back(std::move(conversion));
}

// Adds the node of an earlier conversion of the same Separator, if the state that it depends on is equal.
bool Converter::reuse(const Item& item) {
  const auto found = conversions_.find(item.serial);
  if (found == conversions_.end()) return false;
  for (const Conversion& conversion : found->second) {
    const bool equal = std::all_of(conversion.depends.begin(), conversion.depends.end(), [&](const auto& dependence) {
      return state_.serial(dependence.first) == dependence.second;
    });
    if (!equal) continue;
    for (const auto& [part, serial] : conversion.depends) read(part);
    if (!conversion.node) return true;
    if (const auto target = output_.target()) output_.place(conversion.node, *target);
    if (conversion.has_shapes) output_.note_shape();
    return true;
  }
  return false;
}

NodeId Converter::visit_alone(const Item& item, NodeTarget target) {
  push_state();
  const NodeId node = output_.open_group_in(target, "Group", item.location);
  if (node) {
    if (item.type->keeps_state && item.type->apply == apply_children && item.name.empty())
      visit_children(item);
    else
      visit(item);
  }
  output_.close_group();
  pop_state();
  return node;
}

void Converter::read(Part part) {
  if (!frames_.empty() && !(frames_.back().written & bit(part))) frames_.back().read |= bit(part);
}

State& Converter::write(Part part, std::uint64_t serial) {
  if (!frames_.empty()) frames_.back().written |= bit(part);
  state_.serials[static_cast<std::size_t>(part)] = serial;
  return state_;
}

void Converter::push_state() { frames_.push_back({state_}); }
void Converter::pop_state() { pop_frame(nullptr); }

void Converter::pop_frame(Conversion* conversion) {
  Frame frame = std::move(frames_.back());
  frames_.pop_back();
  state_ = std::move(frame.before);
  for (std::size_t i = 0; i < kParts; ++i) {
    const auto part = static_cast<Part>(i);
    if (!(frame.read & bit(part))) continue;
    if (conversion) conversion->depends.emplace_back(part, state_.serial(part));
    read(part);
  }
}

std::uint64_t Converter::intern(std::string key) {
  // High numbers, so that they differ from serial numbers of nodes.
  const std::uint64_t next = (std::uint64_t{1} << 63) + interned_.size();
  const auto [at, is_new] = interned_.try_emplace(std::move(key), next);
  if (is_new) (void)sink_.scene().memory().charge(at->first.size() + 64);
  return at->second;
}

void Converter::warn_once(SourceLocation location, std::string message) {
  if (said_.size() >= kMaxMessages || !said_.insert(message).second) return;
  sink_.problems().warn(location, std::move(message));
}

void apply_children(Converter& converter, const Item& item) { converter.visit_children(item); }

void apply_unknown(Converter& converter, const Item& item) {
  converter.warn_once(
      item.location,
      "unknown node type " + quoted(item.type->name) +
          (item.children.empty() && item.fields.empty() ? "; skipped" : "; only its children are shown"));
  if (const ItemPtr alternate = item.node("alternateRep")) return converter.visit(*alternate);
  if (item.children.empty() && item.fields.empty()) return;
  converter.push_state();
  converter.visit_children(item);
  for (const ItemField& field : item.fields)
    for (const ItemPtr& node : field.nodes) converter.visit(*node);
  converter.pop_state();
}

}  // namespace gs::vrml::inventor

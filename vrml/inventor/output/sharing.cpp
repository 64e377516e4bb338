#include "vrml/inventor/output/sharing.h"

#include <algorithm>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>
#include <vector>

namespace gs::vrml::inventor {
namespace {

constexpr std::size_t kMaxCandidates = 4;  // different nodes with one hash that are compared

void mix(std::uint64_t& hash, std::uint64_t word) { hash = (hash ^ word) * 0x9E3779B97F4A7C15U ^ hash >> 29; }

void mix_bytes(std::uint64_t& hash, const void* bytes, std::size_t size) {
  mix(hash, std::hash<std::string_view>()({static_cast<const char*>(bytes), size}));
}

std::uint64_t hash_of(const FieldValue& value) {
  std::uint64_t hash = value.index();
  std::visit(
      [&](const auto& one) {
        using Value = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<Value, SFString>)
          mix_bytes(hash, one.view().data(), one.view().size());
        else if constexpr (std::is_same_v<Value, SFNode>)
          mix(hash, one.index);
        else if constexpr (std::is_same_v<Value, MFNode>)
          for (const NodeId id : one) mix(hash, id.index);
        else if constexpr (std::is_same_v<Value, MFString>)
          for (const String& text : one) mix_bytes(hash, text.view().data(), text.view().size());
        else if constexpr (std::is_same_v<Value, MFVec3f> || std::is_same_v<Value, MFVec2f> ||
                           std::is_same_v<Value, MFInt32> || std::is_same_v<Value, MFFloat> ||
                           std::is_same_v<Value, MFColor> || std::is_same_v<Value, MFRotation>)
          mix_bytes(hash, one.data(), one.size() * sizeof(*one.data()));
        else if constexpr (std::is_same_v<Value, SFVec3f> || std::is_same_v<Value, SFVec2f> ||
                           std::is_same_v<Value, SFFloat> || std::is_same_v<Value, SFInt32> ||
                           std::is_same_v<Value, SFColor> || std::is_same_v<Value, SFRotation>)
          mix_bytes(hash, &one, sizeof one);
      },
      value);
  return hash;
}

/// Calls `use` with each node in a value.
template <class Use>
void for_nodes(const FieldValue& value, const Use& use) {
  if (const auto* one = std::get_if<SFNode>(&value)) {
    if (*one) use(*one);
  } else if (const auto* many = std::get_if<MFNode>(&value)) {
    for (const NodeId id : *many)
      if (id) use(id);
  }
}

/// Replaces each node in a value by the result of `replaced`.
template <class Replaced>
void replace_nodes(FieldValue& value, const Replaced& replaced) {
  if (auto* one = std::get_if<SFNode>(&value)) {
    if (*one) *one = replaced(*one);
  } else if (auto* many = std::get_if<MFNode>(&value)) {
    for (std::size_t i = 0; i < many->size(); ++i) {
      const NodeId old = (*many)[i], now = old ? replaced(old) : old;
      if (now != old) many->mutable_data()[i] = now;
    }
  }
}

/// Pass over a converted scene, from the leaves to the roots.
class Sharing {
 public:
  explicit Sharing(SceneGraph& scene)
      : scene_(scene),
        infos_(scene.nodes().count() + 1),
        group_(built_in_node_type("Group")),
        transform_(built_in_node_type("Transform")) {
    for (const Route& route : scene.routes())
      for (const NodeId id : {route.from, route.to}) info(id).fixed = true;
  }

  void run() {
    visit_all([this](NodeId id) { share(id); });
    follow_roots();
    for (Info& each : infos_) each.state = State::unseen;
    count_uses();
    visit_all([this](NodeId id) { tidy(id); });
  }

 private:
  enum class State : std::uint8_t { unseen, open, done };
  struct Info {
    NodeId result;  // node that replaces this one
    std::uint32_t uses = 0;
    State state = State::unseen;
    bool fixed = false;      // has ROUTEs
    bool shareable = false;  // itself and all nodes below
  };

  Info& info(NodeId id) { return infos_[id.index]; }
  [[nodiscard]] std::size_t slots(NodeId id) const { return scene_.node(id).type->defaults.size(); }

  /// Calls `leave` for each node after the nodes below it.
  template <class Leave>
  void visit_all(const Leave& leave) {
    std::vector<std::pair<NodeId, bool>> waiting;
    for (const NodeId root : scene_.roots()) waiting.emplace_back(root, false);
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty()) {
      const auto [id, entered] = waiting.back();
      waiting.pop_back();
      if (entered) {
        leave(id);
        info(id).state = State::done;
        continue;
      }
      if (info(id).state != State::unseen) continue;
      info(id).state = State::open;
      info(id).result = id;
      waiting.emplace_back(id, true);
      const std::size_t first = waiting.size();
      for (std::size_t slot = 0; slot < slots(id); ++slot)
        for_nodes(scene_.node(id).values[slot], [&](const NodeId child) { waiting.emplace_back(child, false); });
      std::reverse(waiting.begin() + static_cast<std::ptrdiff_t>(first), waiting.end());
    }
  }

  void count_uses() {
    visit_all([this](NodeId id) {
      for (std::size_t slot = 0; slot < slots(id); ++slot)
        for_nodes(scene_.node(id).values[slot], [&](const NodeId child) { ++info(child).uses; });
    });
    for (const NodeId root : scene_.roots()) ++info(root).uses;
    for (Info& each : infos_) each.state = State::unseen;
  }

  void follow_roots() {
    MFNode roots = scene_.roots();
    for (std::size_t i = 0; i < roots.size(); ++i) roots.mutable_data()[i] = info(roots[i]).result;
    scene_.set_roots(std::move(roots));
    for (Statement& statement : scene_.statements())
      if (statement.kind == Statement::Kind::node) statement.node = info(statement.node).result;
  }

  // Reports whether several uses of one node mean the same as copies of it.
  [[nodiscard]] bool may_share(const Node& node) const {
    constexpr Role kOwnState =
        Role::bindable | Role::sensor | Role::interpolator | Role::time_dependent | Role::sound_source | Role::script;
    return node.type->kind == NodeType::Kind::built_in && node.type->url_content == UrlContent::none &&
           node.type->read_as != NodeKind::sound && !has(node.type->role, kOwnState);
  }

  // Reports whether a Group or Transform only holds its children.
  [[nodiscard]] bool is_plain(NodeId id) {
    const Node& node = scene_.node(id);
    if ((node.type != group_ && node.type != transform_) || !node.name.empty() || info(id).fixed) return false;
    const int children = node.type->find_field("children")->slot;
    for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot)
      if (static_cast<int>(slot) != children && node.values[slot] != node.type->defaults[slot]) return false;
    return true;
  }

  // Reports whether a node needs no group around it: no light or sensor, which would affect other nodes.
  [[nodiscard]] bool stands_alone(NodeId id) const {
    const Node& node = scene_.node(id);
    return node.type->read_as == NodeKind::shape || has(node.type->role, Role::grouping);
  }

  const MFNode& children_of(NodeId id) const { return scene_.get<MFNode>(id, "children"); }

  // Replaces the nodes below by equal ones, and then the node itself.
  void share(NodeId id) {
    Node& node = scene_.node(id);
    bool shareable = may_share(node) && !info(id).fixed;
    std::uint64_t hash = std::hash<const void*>()(node.type);
    for (std::size_t slot = 0; slot < slots(id); ++slot) {
      replace_nodes(node.values[slot], [&](NodeId child) {
        const Info& below = info(child);
        const bool done = below.state == State::done;
        shareable = shareable && done && info(below.result).shareable;
        return done ? below.result : child;
      });
      mix(hash, hash_of(node.values[slot]));
    }
    info(id).shareable = shareable;
    if (is_plain(id) && children_of(id).size() == 1 && children_of(id)[0] && stands_alone(children_of(id)[0])) {
      info(id).result = children_of(id)[0];
      return;
    }
    if (!shareable) return;
    std::vector<NodeId>& known = known_[hash];
    const auto equal = std::find_if(known.begin(), known.end(), [&](NodeId other) { return are_equal(id, other); });
    if (equal != known.end())
      info(id).result = *equal;
    else if (known.size() < kMaxCandidates)
      known.push_back(id);
  }

  [[nodiscard]] bool are_equal(NodeId a, NodeId b) const {
    const Node &first = scene_.node(a), &second = scene_.node(b);
    if (first.type != second.type || first.name != second.name || first.text != second.text) return false;
    return std::equal(first.values, first.values + first.type->defaults.size(), second.values);
  }

  // Replaces the only child of a group by its children if it is a plain Group. Gives each use of a node without values
  // a node of its own, because a name and a USE would be longer.
  void tidy(NodeId id) {
    if (scene_.node(id).type == group_ || scene_.node(id).type == transform_) {
      const MFNode& children = children_of(id);
      if (children.size() == 1 && children[0] && info(children[0]).uses == 1 && is_plain(children[0]))
        scene_.set(id, "children", MFNode(children_of(children[0])));
    }
    for (std::size_t slot = 0; slot < slots(id); ++slot) {
      auto* const child = std::get_if<SFNode>(&scene_.node(id).values[slot]);
      if (!child || !*child || info(*child).uses < 2 || !has_no_values(*child)) continue;
      --info(*child).uses;
      const Node& old = scene_.node(*child);
      const NodeId copy = scene_.create(*old.type, old.location);
      if (copy) *std::get_if<SFNode>(&scene_.node(id).values[slot]) = copy;
    }
  }

  [[nodiscard]] bool has_no_values(NodeId id) const {
    const Node& node = scene_.node(id);
    return node.name.empty() && !node.type->defaults.empty() && may_share(node) &&
           std::equal(node.type->defaults.begin(), node.type->defaults.end(), node.values);
  }

  SceneGraph& scene_;
  std::vector<Info> infos_;
  const NodeType *group_, *transform_;
  std::unordered_map<std::uint64_t, std::vector<NodeId>> known_;  // shared nodes by their hash
};

}  // namespace

void share_equal_nodes(SceneGraph& scene) {
  constexpr std::size_t kBytesPerNode = 96;
  const std::size_t bytes = scene.nodes().count() * kBytesPerNode;
  Share memory(scene.budget(), Resource::nodes);
  if (&scene.texts().writing() != &scene || !memory.grow(bytes)) return;
  Sharing(scene).run();
}

}  // namespace gs::vrml::inventor

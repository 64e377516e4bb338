#include "app/formats/confined/scene_transfer.h"

#include "app/formats/common/import_context.h"
#include "app/formats/gltf/gltf.h"
#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

using vrml::NodeKind;

/// Kinds of nodes that importers make.
constexpr std::array kImportedKinds = {NodeKind::transform,
                                       NodeKind::shape,
                                       NodeKind::viewpoint,
                                       NodeKind::appearance,
                                       NodeKind::material,
                                       NodeKind::physical_material,
                                       NodeKind::image_texture,
                                       NodeKind::coordinate,
                                       NodeKind::normal,
                                       NodeKind::color,
                                       NodeKind::texture_coordinate,
                                       NodeKind::indexed_face_set,
                                       NodeKind::indexed_line_set,
                                       NodeKind::point_set};
constexpr std::size_t kLeastNode = 18;  // bytes: kind, language, name, number of values

const vrml::NodeType& type_of_kind(NodeKind kind, vrml::Language language) {
  return language == vrml::Language::x3d ? vrml::x3d_node_type(kind) : vrml::built_in_node_type(kind);
}

bool is_imported(NodeKind kind, vrml::Language language) {
  if (std::ranges::find(kImportedKinds, kind) == kImportedKinds.end()) return false;
  const bool x3d = language == vrml::Language::x3d;
  return kind == NodeKind::physical_material ? x3d : !x3d || kind == NodeKind::appearance;
}
bool is_imported(const vrml::NodeType& type) {
  return type.kind == vrml::NodeType::Kind::built_in && is_imported(type.read_as, type.language) &&
         &type == &type_of_kind(type.read_as, type.language);
}

/// Nodes of a scene below its roots, children before their parents, each once.
class NodeOrder {
 public:
  explicit NodeOrder(const vrml::SceneGraph& scene) : scene_(scene) {
    for (const vrml::NodeId root : scene.roots()) visit(root);
  }
  [[nodiscard]] const std::vector<vrml::NodeId>& nodes() const { return nodes_; }
  /// Returns the number of a node from 1 on, or 0 for a null node.
  [[nodiscard]] std::uint32_t number(vrml::NodeId node) const { return node ? numbers_.at(node.index) : 0; }

 private:
  struct Visit {
    vrml::NodeId node;
    std::vector<vrml::NodeId> children;
  };
  [[nodiscard]] std::vector<vrml::NodeId> children_of(vrml::NodeId id) const {
    std::vector<vrml::NodeId> all;
    const vrml::Node& node = scene_.node(id);
    for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot) {
      if (const auto* const one = std::get_if<vrml::SFNode>(&node.values[slot]); one && *one) all.push_back(*one);
      if (const auto* const many = std::get_if<vrml::MFNode>(&node.values[slot]))
        for (const vrml::NodeId child : *many)
          if (child) all.push_back(child);
    }
    std::ranges::reverse(all);  // the first one is visited first
    return all;
  }
  void visit(vrml::NodeId root) {
    if (!root || !numbers_.try_emplace(root.index, 0).second) return;
    std::vector<Visit> path{{root, children_of(root)}};
    while (!path.empty()) {
      if (path.back().children.empty()) {
        nodes_.push_back(path.back().node);
        numbers_[path.back().node.index] = static_cast<std::uint32_t>(nodes_.size());
        path.pop_back();
        continue;
      }
      const vrml::NodeId next = path.back().children.back();
      path.back().children.pop_back();
      if (numbers_.try_emplace(next.index, 0).second) path.push_back({next, children_of(next)});
    }
  }

  const vrml::SceneGraph& scene_;
  std::vector<vrml::NodeId> nodes_;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;  // by index in the scene
};

// ---- Values. Strings are numbers of a list of texts, because pictures in them are long and often the same.

/// Texts of a scene, each once.
class TextNumbers {
 public:
  std::uint32_t number(const vrml::String& text) {
    const auto [entry, added] = numbers_.try_emplace(text.view(), static_cast<std::uint32_t>(texts_.size()));
    if (added) texts_.push_back(text);
    return entry->second;
  }
  [[nodiscard]] const std::vector<vrml::String>& texts() const { return texts_; }

 private:
  std::vector<vrml::String> texts_;  // own the bytes of the keys
  std::unordered_map<std::string_view, std::uint32_t> numbers_;
};

template <class T>
constexpr bool kIsPlainPart =
    std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool> && !std::is_same_v<T, vrml::NodeId>;

/// Writer of the values of nodes.
class FieldWriter {
 public:
  FieldWriter(TransferWriter& to, const NodeOrder& order, TextNumbers& texts) : to_(to), order_(order), texts_(texts) {}

  void operator()(bool value) { to_.value<std::uint8_t>(value); }
  void operator()(vrml::NodeId node) { to_.value(order_.number(node)); }
  void operator()(const vrml::String& text) { to_.value(texts_.number(text)); }
  void operator()(const vrml::PixelImage& image) { to_.list(image.words); }
  template <class T>
  requires kIsPlainPart<T>
  void operator()(const T& value) { to_.value(value); }
  template <class T, int kInitial>
  void operator()(const Boxed<T, kInitial>& value) {
    to_.value(*value);
  }
  template <class T>
  void operator()(const Array<T>& array) {
    if constexpr (kIsPlainPart<T>) {
      to_.list(array);
    } else {
      to_.value<std::uint64_t>(array.size());
      for (const T& one : array) (*this)(one);
    }
  }

 private:
  TransferWriter& to_;
  const NodeOrder& order_;
  TextNumbers& texts_;
};

/// Reader of what FieldWriter writes.
class FieldReader {
 public:
  FieldReader(TransferReader& from, const std::vector<vrml::NodeId>& nodes, const std::vector<vrml::String>& texts)
      : from_(from), nodes_(nodes), texts_(texts) {}

  void operator()(bool& value) { value = from_.truth(); }
  void operator()(vrml::NodeId& node) {
    const auto number = from_.value<std::uint32_t>();
    require_possible(number <= nodes_.size());
    node = number == 0 ? vrml::NodeId{} : nodes_[number - 1];
  }
  void operator()(vrml::String& text) {
    const auto number = from_.value<std::uint32_t>();
    require_possible(number < texts_.size());
    text = texts_[number];
  }
  void operator()(vrml::PixelImage& image) {
    image.words = from_.array<std::uint32_t>();
    constexpr std::size_t kHead = 3, kMostComponents = 4;
    require_possible(image.words.empty() ||
                     (image.words.size() >= kHead && image.components() <= kMostComponents &&
                      std::uint64_t{image.width()} * image.height() == image.words.size() - kHead));
  }
  template <class T>
  requires kIsPlainPart<T>
  void operator()(T& value) { value = from_.value<T>(); }
  template <class T, int kInitial>
  void operator()(Boxed<T, kInitial>& value) {
    value = Boxed<T, kInitial>(from_.value<T>());
  }
  template <class T>
  void operator()(Array<T>& array) {
    if constexpr (kIsPlainPart<T>) {
      array = from_.array<T>();
    } else {
      constexpr std::size_t kLeast = std::is_same_v<T, bool> ? 1 : sizeof(std::uint32_t);
      array.resize(from_.count(kLeast));
      T* const elements = array.mutable_data();
      for (std::size_t i = 0; i < array.size(); ++i) (*this)(elements[i]);
    }
  }

 private:
  TransferReader& from_;
  const std::vector<vrml::NodeId>& nodes_;
  const std::vector<vrml::String>& texts_;
};

/// Reader of a scene.
class SceneReader {
 public:
  SceneReader(TransferReader& from, const ImportSource& source)
      : from_(from), scene_(std::make_unique<vrml::SceneGraph>(source.path, source.budget)) {
    if (source.for_x3d) scene_->set_language(vrml::Language::x3d, kX3DVersionOfGltf);
  }

  std::unique_ptr<vrml::SceneGraph> read() {
    charge(from_.left());
    constexpr std::size_t kLeastText = 8;  // bytes
    for (std::size_t left = from_.count(kLeastText); left > 0; --left) {
      const std::vector<char> text = from_.list<char>();
      texts_.emplace_back(std::string_view(text.data(), text.size()));
    }
    const std::size_t nodes = from_.count(kLeastNode);
    for (std::size_t i = 0; i < nodes; ++i) read_node();
    for (const std::uint32_t root : from_.list<std::uint32_t>()) {
      require_possible(root > 0 && root <= nodes_.size());
      scene_->add_root(nodes_[root - 1]);
    }
    return std::move(scene_);
  }

 private:
  void charge(std::size_t bytes) {
    if (!scene_->memory().charge(bytes)) throw OutOfBudget();
  }
  void read_node() {
    const auto kind = static_cast<NodeKind>(from_.value<std::uint8_t>());
    const auto language = from_.truth() ? vrml::Language::x3d : vrml::Language::vrml97;
    require_possible(is_imported(kind, language));
    const std::string name = from_.text();
    const vrml::NodeType& type = type_of_kind(kind, language);
    require_possible(from_.value<std::uint64_t>() == type.defaults.size());
    const vrml::NodeId id = scene_->create(type);
    if (!id) throw OutOfBudget();
    vrml::Node& node = scene_->node(id);
    if (!name.empty()) {
      const auto kept = scene_->texts().keep_name(name);
      if (!kept) throw OutOfBudget();
      node.name = *kept;
    }
    std::size_t depth = 0;
    for (std::size_t slot = 0; slot < type.defaults.size(); ++slot) {
      std::visit(FieldReader(from_, nodes_, texts_), node.values[slot]);
      if (const auto* const one = std::get_if<vrml::SFNode>(&node.values[slot]))
        depth = std::max(depth, depth_of(*one));
      if (const auto* const many = std::get_if<vrml::MFNode>(&node.values[slot]))
        for (const vrml::NodeId child : *many) depth = std::max(depth, depth_of(child));
    }
    require_possible(depth < scene_->limits().nesting);
    depths_[id.index] = depth + 1;
    nodes_.push_back(id);
  }
  [[nodiscard]] std::size_t depth_of(vrml::NodeId node) const { return node ? depths_.at(node.index) : 0; }

  TransferReader& from_;
  std::unique_ptr<vrml::SceneGraph> scene_;
  std::vector<vrml::String> texts_;
  std::vector<vrml::NodeId> nodes_;
  std::unordered_map<std::uint32_t, std::size_t> depths_;  // levels of nodes below a node and with it
};

}  // namespace

bool can_transfer(const vrml::SceneGraph& scene) {
  if (!scene.routes().empty()) return false;
  const NodeOrder order(scene);
  return std::ranges::all_of(order.nodes(), [&](vrml::NodeId id) { return is_imported(*scene.node(id).type); });
}

void write_scene(TransferWriter& to, const vrml::SceneGraph& scene) {
  const NodeOrder order(scene);
  TextNumbers texts;
  TransferWriter nodes;
  for (const vrml::NodeId id : order.nodes()) {
    const vrml::Node& node = scene.node(id);
    nodes.value(static_cast<std::uint8_t>(node.type->read_as));
    nodes.value<std::uint8_t>(node.type->language == vrml::Language::x3d);
    nodes.text(node.name);
    nodes.value<std::uint64_t>(node.type->defaults.size());
    for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot)
      std::visit(FieldWriter(nodes, order, texts), node.values[slot]);
  }
  to.value<std::uint64_t>(texts.texts().size());
  for (const vrml::String& text : texts.texts()) to.text(text.view());
  to.value<std::uint64_t>(order.nodes().size());
  to.append(nodes);
  std::vector<std::uint32_t> roots;
  for (const vrml::NodeId root : scene.roots())
    if (root) roots.push_back(order.number(root));
  to.list(roots);
}

std::unique_ptr<vrml::SceneGraph> read_scene(TransferReader& from, const ImportSource& source) {
  return SceneReader(from, source).read();
}

}  // namespace gs::app

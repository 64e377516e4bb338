#pragma once

#include "base/noncopyable.h"
#include "vrml/inventor/state.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <unordered_map>

namespace gs::vrml::inventor {

class Converter;

/// Kind of a shape, as far as its colours depend on it.
enum class ShapeKind : std::uint8_t { faces, lines, text };

/// Appearance of a shape.
struct Look {
  std::string material;                      // identity of the Material; empty for none
  std::uint64_t texture = 0, transform = 0;  // identities; 0 means none
  std::size_t index = 0;                     // index in the lists of the material
  bool lit = true;
  bool varies = false;  // `colors` give the colour of each part
  MFColor colors;
  std::uint64_t colors_serial = 0;
  [[nodiscard]] std::string key() const;
};

/// Appearances of shapes. Shapes with an equal appearance share its node. One thread.
class Looks : NonCopyable {
 public:
  explicit Looks(Converter& converter) : converter_(converter) {}

  /// Returns the appearance of a shape with this state. `index` selects the material, unless `varies` is set: then the
  /// colours come from a Color node.
  [[nodiscard]] Look of(const State& state, ShapeKind kind, bool varies, std::size_t index = 0);
  /// Sets the appearance of a Shape. `state` is that of the look.
  void apply(NodeId shape, const Look& look, const State& state, SourceLocation location);
  /// Returns the node of a geometric property with this identity, for reading or setting; null if there is none.
  [[nodiscard]] NodeId& property(const std::string& identity) { return properties_[identity]; }

 private:
  void add_material(NodeId appearance, const Look& look, const State& state, SourceLocation location);
  void add_texture(NodeId appearance, const Look& look, const State& state, SourceLocation location);

  Converter& converter_;
  std::unordered_map<std::string, NodeId> appearances_, materials_, properties_;
  std::unordered_map<std::uint64_t, NodeId> textures_, transforms_;
};

}  // namespace gs::vrml::inventor

#pragma once

#include "base/noncopyable.h"
#include "vrml/inventor/item.h"
#include "vrml/inventor/looks.h"
#include "vrml/inventor/output/output.h"
#include "vrml/inventor/state.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::vrml::inventor {

/// Traversal of the nodes of a VRML 1.0 or Inventor file, which converts them to VRML97.
///
/// Keeps the traversal state, and records which parts of it a Separator reads. A further use of the Separator becomes a
/// USE if these parts are equal. Work and depth are limited, so that nested uses cannot multiply without end. One
/// thread.
class Converter : NonCopyable {
 public:
  explicit Converter(SceneSink& sink) : sink_(sink), output_(sink), looks_(*this) {}

  /// Converts a node with its children. `read_nodes` is the number of nodes in the text so far, which limits the work.
  void convert(const Item& item, std::uint64_t read_nodes);
  /// Sets the crease angle of shapes without hints, which depends on the version of the file. Call it first.
  void set_crease_angle(float angle) { crease_angle_ = state_.hints.crease_angle = angle; }
  [[nodiscard]] float crease_angle() const { return crease_angle_; }
  /// Returns the unit of the current transformation, in metres; see the node Units.
  [[nodiscard]] double unit() const { return state_.unit; }
  void set_unit(double meters) { state_.unit = meters; }
  /// Applies a node to the state and the scene. Rows of the table call it for children and parts.
  void visit(const Item& item);
  void visit_children(const Item& item);
  /// Applies a node inside a new group of type `type`, which becomes one child of `target`, even if it is empty.
  NodeId visit_alone(const Item& item, NodeTarget target);

  [[nodiscard]] SceneSink& sink() { return sink_; }
  [[nodiscard]] Output& output() { return output_; }
  [[nodiscard]] Looks& looks() { return looks_; }

  /// Returns the state. Call read() for each part that the caller uses.
  [[nodiscard]] const State& state() const { return state_; }
  void read(Part part);
  /// Returns the state for changes of one part, with the identity `serial` of its new value.
  [[nodiscard]] State& write(Part part, std::uint64_t serial);
  /// Stores the state, and restores it.
  void push_state();
  void pop_state();
  /// Returns a DEF name that no file is likely to use.
  [[nodiscard]] std::string unique_name(std::string_view word) {
    return '_' + std::string(word) + std::to_string(++names_);
  }
  /// Returns a number that is equal for equal texts.
  [[nodiscard]] std::uint64_t intern(std::string key);

  /// Returns the last camera, if there was one.
  [[nodiscard]] const std::optional<CameraState>& camera() const { return camera_; }
  void set_camera(const CameraState& camera) { camera_ = camera; }

  /// Returns the attenuation of local lights: factors of the square, of the distance, and constant.
  [[nodiscard]] const SFVec3f& attenuation() const { return state_.attenuation; }
  void set_attenuation(const SFVec3f& attenuation) { state_.attenuation = attenuation; }

  void warn_once(SourceLocation location, std::string message);
  /// Reports whether the node that is being converted may be used again.
  [[nodiscard]] bool may_repeat() const { return named_depth_ > 0; }
  /// Reports whether the text may go on; false after a limit was reached.
  [[nodiscard]] bool may_go_on(SourceLocation location);

 private:
  /// State before a Separator, and the parts of it that were read and set inside.
  struct Frame {
    State before;
    std::uint32_t read = 0, written = 0;
  };
  /// Converted Separator, with the parts of the state that it depends on.
  struct Conversion {
    std::vector<std::pair<Part, std::uint64_t>> depends;
    NodeId node;  // null if it has no visible content
    bool has_shapes = false;
  };

  void visit_scope(const Item& item);
  [[nodiscard]] bool reuse(const Item& item);
  void pop_frame(Conversion* conversion);

  SceneSink& sink_;
  Output output_;
  Looks looks_;
  State state_;
  std::vector<Frame> frames_;
  std::unordered_map<std::uint64_t, std::vector<Conversion>> conversions_;  // by Item::serial
  std::unordered_map<std::string, std::uint64_t> interned_;
  std::unordered_set<std::string> said_;
  std::uint64_t visits_ = 0, max_visits_ = 0, names_ = 0;
  std::size_t depth_ = 0, named_depth_ = 0;
  std::optional<CameraState> camera_;
  float crease_angle_ = 0.5F;
  bool said_work_ = false, said_depth_ = false;
};

/// Applies the children of a group.
void apply_children(Converter& converter, const Item& item);
/// Returns the matrix in 16 numbers of a file, which uses row vectors.
[[nodiscard]] glm::dmat4 matrix_of(const MFFloat& numbers, std::size_t first);
/// Draws the children of a node without a row in the table.
void apply_unknown(Converter& converter, const Item& item);

}  // namespace gs::vrml::inventor

#pragma once

#include "app/inspect/console.h"
#include "app/inspect/event_watch.h"
#include "app/inspect/node_editor.h"
#include "app/inspect/route_list.h"
#include "app/inspect/scene_index.h"
#include "app/inspect/scene_outline.h"
#include "app/inspect/selection_marks.h"
#include "app/inspect/stream_list.h"
#include "app/session/session.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gs::app {

/// Open panels of the inspection; closed ones cost nothing.
struct InspectionWants {
  bool tree = false, inspector = false, routes = false, console = false, streams = false;
  bool arrows = false;  // arrow keys go to the tree instead of the viewer
  [[nodiscard]] bool any() const { return tree || inspector || routes || console || streams; }
  [[nodiscard]] bool world() const { return tree || inspector || routes || console; }
};

/// Inspection of the world in a session's active viewport: node tree, selected node, ROUTEs, programs and streams. It
/// applies the user's edits as a SessionExtension in the session's next step. Events thus take the same path as those
/// of remote control. Use on the session's thread. The session must outlive it or remove it.
class Inspection final : public SessionExtension {
 public:
  Inspection() = default;
  Inspection(const Inspection&) = delete;
  Inspection& operator=(const Inspection&) = delete;

  bool act(Session& session) override;
  /// Updates all data below to the present world. Call before drawing the interface, with the pictures of the worlds.
  /// `now` is in seconds of any clock.
  void prepare(Session& session, std::span<const Frame::Picture> pictures, double now);
  /// Reports whether work or changes are pending that no event announces: step and draw again at once.
  [[nodiscard]] bool busy() const;
  /// Returns the seconds until its display changes without an event; nullopt if it will not.
  [[nodiscard]] std::optional<double> next_change() const;
  /// Reports whether displayed data changed since the last call. Limits the rate of updates.
  [[nodiscard]] bool take_news(double now);

  /// Panels that are drawn in the present picture. Each panel sets its flag every time; its data are current from the
  /// next step on.
  [[nodiscard]] InspectionWants& drawn() { return drawn_; }
  [[nodiscard]] bool takes_arrows() const { return wants_.arrows; }
  /// Returns null if no live world is shown.
  [[nodiscard]] vrml::Execution* world() const { return world_; }
  [[nodiscard]] SceneOutline& outline() { return outline_; }
  [[nodiscard]] SceneIndex& index() { return index_; }
  [[nodiscard]] const EventWatch& events() const { return watch_; }
  [[nodiscard]] RouteList& routes() { return routes_; }
  [[nodiscard]] ScriptConsole& console() { return console_; }
  [[nodiscard]] StreamList& streams() { return streams_; }
  /// Returns the values of the selected node, and edits of them.
  [[nodiscard]] NodeEditor& editor() { return editor_; }
  /// Returns the outline of the selected node in the pictures.
  [[nodiscard]] const SelectionMark& mark() const { return mark_; }

  /// Selects a node; null selects none. `reveal` expands the tree and scrolls to the node.
  void select(const NodeAt& node, bool reveal);
  [[nodiscard]] const NodeAt& selected() const { return selected_; }
  /// Returns the tree line to scroll to, once.
  [[nodiscard]] std::optional<std::size_t> take_revealed() { return std::exchange(revealed_, std::nullopt); }
  /// Selects the node at a framebuffer pixel. Returns false if there is none.
  bool pick(Session& session, const glm::vec2& pixel);
  /// Makes the next click in the picture select a node.
  void set_picking(bool picking) { picking_ = picking; }
  [[nodiscard]] bool picking() const { return picking_; }
  /// Moves the viewer to frame the selected node. Returns false if nothing of it is visible.
  bool fly_to_selected();
  /// Selects the next (or, if `before`, the previous) match in the order of the text.
  void find_next(bool before);
  /// Searches nodes by DEF name and type (see SceneIndex::find), and selects the first.
  void find(const std::string& text);
  /// Returns the index of the selected match.
  [[nodiscard]] std::optional<std::size_t> match() const { return match_; }

 private:
  void enter(const std::shared_ptr<Document>& document);
  void reveal_pending();

  InspectionWants wants_, drawn_;
  std::shared_ptr<Document> document_;  // declared before all members that refer to it
  vrml::Execution* world_ = nullptr;
  SceneIndex index_;
  SceneOutline outline_;
  EventWatch watch_;
  RouteList routes_;
  ScriptConsole console_;
  StreamList streams_;
  NodeEditor editor_;
  SelectionMark mark_;

  NodeAt selected_;
  bool finds_ = false;  // select the first match when it is found
  bool reveal_ = false, picking_ = false, fly_ = false, more_ = false;
  std::optional<std::size_t> revealed_, match_;
  double last_news_ = 0, shown_at_ = 0, clock_ = 0;
  bool news_ = false;
};

}  // namespace gs::app

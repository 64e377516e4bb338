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
#include "base/noncopyable.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gs::app {

/// Flags of the panels that are open. A closed panel costs nothing.
struct InspectionWants {
  bool tree = false, inspector = false, routes = false, console = false, streams = false;
  bool arrows = false;  // true if arrow keys move in the tree, false if they move the viewer
  [[nodiscard]] bool any() const { return tree || inspector || routes || console || streams; }
  [[nodiscard]] bool world() const { return tree || inspector || routes || console; }
};

/// Inspection of the world in the active viewport of a session: node tree, selected node, ROUTEs, programs and streams.
/// Applies the user's edits in the next step, as a SessionExtension. Edits thus have the same effects as events of
/// remote control. Session's thread. The session must outlive the inspection or remove it.
class Inspection final : public SessionExtension, NonCopyable {
 public:
  bool act(Session& session) override;
  /// Updates all data of the panels to the current world. Call before the interface is drawn, with the pictures of the
  /// worlds. `now` is in seconds of any clock.
  void prepare(Session& session, std::span<const Frame::Picture> pictures, double now);
  /// Returns true if the next step and picture must follow at once, because work remains or changes have no event.
  [[nodiscard]] bool busy() const;
  /// Returns the number of seconds until the panels change without an event, or nullopt if they will not.
  [[nodiscard]] std::optional<double> next_change() const;
  /// Returns true if data of the panels have changed since the last call. Limits the rate of such changes.
  [[nodiscard]] bool take_news(double now);

  /// Returns flags for the panels that are being drawn. Each panel sets its flag in each picture. Its data are up to
  /// date from the next step on.
  [[nodiscard]] InspectionWants& drawn() { return drawn_; }
  [[nodiscard]] bool takes_arrows() const { return wants_.arrows; }
  /// Returns the world, or null if the viewport shows no running world.
  [[nodiscard]] vrml::Execution* world() const { return world_; }
  [[nodiscard]] SceneOutline& outline() { return outline_; }
  [[nodiscard]] SceneIndex& index() { return index_; }
  [[nodiscard]] const EventWatch& events() const { return watch_; }
  [[nodiscard]] RouteList& routes() { return routes_; }
  [[nodiscard]] ScriptConsole& console() { return console_; }
  [[nodiscard]] StreamList& streams() { return streams_; }
  /// Returns the editor, which has the values of the selected node and sends edits of them.
  [[nodiscard]] NodeEditor& editor() { return editor_; }
  /// Undoes (-1) or redoes (1) the last edit of the world in the active viewport, in the next step.
  void step_edit(int direction) { step_ = direction; }
  /// Returns the mark: the outline of the selected node in the pictures.
  [[nodiscard]] const SelectionMark& mark() const { return mark_; }

  /// Selects a node; a null node ends the selection. `reveal` expands the tree down to the node and scrolls there.
  void select(const NodeAt& node, bool reveal);
  [[nodiscard]] const NodeAt& selected() const { return selected_; }
  /// Returns the tree line to scroll to, the first time; then nullopt.
  [[nodiscard]] std::optional<std::size_t> take_revealed() { return std::exchange(revealed_, std::nullopt); }
  /// Selects the node that is visible at a framebuffer pixel. Returns false if there is none.
  bool pick(Session& session, const glm::vec2& pixel);
  /// Sets whether the next click in the picture selects a node.
  void set_picking(bool picking) { picking_ = picking; }
  [[nodiscard]] bool picking() const { return picking_; }
  /// Moves the viewer so that the selected node fills the picture. Returns false if the node is not visible.
  bool fly_to_selected();
  /// Selects the next match of the search, in the order of the text. With `before`, selects the previous match.
  void find_next(bool before);
  /// Searches nodes with this text in their DEF name or type (see SceneIndex::find), and selects the first match.
  void find(const std::string& text);
  /// Returns the index of the selected match, or nullopt.
  [[nodiscard]] std::optional<std::size_t> match() const { return match_; }

 private:
  void enter(const std::shared_ptr<Document>& document);
  void reveal_pending();

  InspectionWants wants_, drawn_;
  std::shared_ptr<Document> document_;  // first, because members below refer to it
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
  bool finds_ = false;  // true until the first match was selected
  bool reveal_ = false, picking_ = false, fly_ = false, more_ = false;
  std::optional<std::size_t> revealed_, match_;
  int step_ = 0;  // argument of step_edit(); 0 means none
  double last_news_ = 0, shown_at_ = 0, clock_ = 0;
  bool news_ = false;
};

}  // namespace gs::app

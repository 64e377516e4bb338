#pragma once

#include "app/inspect/console.h"
#include "app/inspect/event_watch.h"
#include "app/inspect/route_list.h"
#include "app/inspect/scene_index.h"
#include "app/inspect/scene_outline.h"
#include "app/inspect/selection_marks.h"
#include "app/inspect/stream_list.h"
#include "app/session/session.h"
#include "vrml/events/node_names.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// What of a world somebody looks at: nothing else costs anything.
struct InspectionWants {
  bool tree = false, inspector = false, routes = false, console = false, streams = false;
  bool arrows = false;  // keys that go to the tree, and not to the viewer
  [[nodiscard]] bool any() const { return tree || inspector || routes || console || streams; }
  [[nodiscard]] bool world() const { return tree || inspector || routes || console; }
};

/// Looks into the world of a session's active viewport: its tree, one chosen node, its ROUTEs, programs and streams;
/// and does there what the user asks for, with the next step of the session: a guest of it, as those are who control it
/// from outside, so that events go the same way. One thread, that of the session, which must outlive it or remove it.
class Inspection final : public SessionGuest {
 public:
  Inspection() = default;
  Inspection(const Inspection&) = delete;
  Inspection& operator=(const Inspection&) = delete;

  bool act(Session& session) override;
  void step_is_over() override {}
  /// Before a picture of it is made, beside those of the worlds: all below is as the world is now. `now`: seconds of
  /// any clock.
  void prepare(Session& session, std::span<const Frame::Picture> pictures, double now);
  /// There is something to be done or to be shown that no event will tell of: a step and a picture are to follow at
  /// once.
  [[nodiscard]] bool busy() const;
  /// Seconds until a picture of it would be another one though nothing happens; nothing: none would.
  [[nodiscard]] std::optional<double> next_change() const;
  /// Something has happened since the last call that it shows, and the last picture of it is a while ago.
  [[nodiscard]] bool take_news(double now);

  /// What is drawn of it in the picture that is being made: who draws says so there, each time. It is up to date from
  /// the next step on.
  [[nodiscard]] InspectionWants& drawn() { return drawn_; }
  [[nodiscard]] bool takes_arrows() const { return wants_.arrows; }
  /// Null: there is no world that lives.
  [[nodiscard]] vrml::Execution* world() const { return world_; }
  [[nodiscard]] SceneOutline& outline() { return outline_; }
  [[nodiscard]] SceneIndex& index() { return index_; }
  [[nodiscard]] const EventWatch& events() const { return watch_; }
  [[nodiscard]] const RouteList& routes() const { return routes_; }
  /// Only those of the chosen node are listed.
  void set_routes_only(bool only) { routes_only_ = only; }
  [[nodiscard]] bool routes_only() const { return routes_only_; }
  [[nodiscard]] ScriptConsole& console() { return console_; }
  [[nodiscard]] const StreamList& streams() const { return streams_; }

  /// A node is chosen from now on; null: none. `reveal`: the tree opens and shows it.
  void select(const NodeAt& node, bool reveal);
  [[nodiscard]] const NodeAt& selected() const { return selected_; }
  /// The line of the tree that is to be brought into sight, once.
  [[nodiscard]] std::optional<std::size_t> take_revealed() { return std::exchange(revealed_, std::nullopt); }
  /// Chooses what is seen at a framebuffer pixel. False: there is nothing.
  bool pick(Session& session, const glm::vec2& pixel);
  /// The next click in the picture picks.
  void set_picking(bool picking) { picking_ = picking; }
  [[nodiscard]] bool picking() const { return picking_; }
  /// The viewer flies to where he sees the chosen node. False: nothing of it is shown.
  bool fly_to_selected();
  /// Chooses the match in the order of the text that follows the chosen one, or is before it.
  void find_next(bool before);
  /// Looks for nodes by DEF name and type, see SceneIndex::find, and chooses the first.
  void find(const std::string& text);
  /// Which of the matches is chosen.
  [[nodiscard]] std::optional<std::size_t> match() const { return match_; }
  /// Around what the picture shows of the chosen node; framebuffer pixels, and the viewport to which they are cut.
  struct Mark {
    Viewport viewport;
    std::vector<PixelLine> lines;
  };
  [[nodiscard]] const std::vector<Mark>& marks() const { return marks_; }
  [[nodiscard]] const render::WorldBounds& selected_bounds() const { return bounds_; }

  /// The value that is shown of an interface of the chosen node; null: an eventIn has none. Until the world goes on.
  [[nodiscard]] const vrml::FieldValue* value_of(const vrml::InterfaceDeclaration& interface) const;
  /// Sends an event to the chosen node: a text as VRML97 has it, or a value. What is wrong with it, if anything: then
  /// it is not sent.
  [[nodiscard]] std::optional<std::string> send_text(const vrml::InterfaceDeclaration& event_in,
                                                     const std::string& text);
  [[nodiscard]] std::optional<std::string> send(const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value);
  /// Where a url of the chosen node's leads, for who opens it; nothing: nowhere.
  [[nodiscard]] std::optional<std::string> target_of_url(const vrml::InterfaceDeclaration& url,
                                                         std::size_t index) const;
  /// One element of a list; the rest stays as it is.
  [[nodiscard]] std::optional<std::string> send_element(const vrml::InterfaceDeclaration& event_in,
                                                        const vrml::FieldValue& list, std::size_t index,
                                                        const vrml::FieldValue& element);
  [[nodiscard]] std::optional<std::string> send_element_text(const vrml::InterfaceDeclaration& event_in,
                                                             const vrml::FieldValue& list, std::size_t index,
                                                             const std::string& text);

  /// A line for the script console, which is run in the chosen node if that is a Script, else by itself.
  void evaluate(const std::string& line);
  /// The Script that lines are run in; null: none.
  [[nodiscard]] NodeAt console_script() const;

  /// Stops a stream, or asks for it anew: by the url of its node, or with its whole world.
  void cancel(const StreamList::Row& row) const { row.ledger->cancel(row.load.number); }
  void retry(const StreamList::Row& row);

 private:
  struct Edit {
    NodeAt node;
    const vrml::InterfaceDeclaration* event_in;
    vrml::FieldValue value;
  };
  void enter(const std::shared_ptr<Document>& document);
  bool deliver();
  void reveal_pending();
  void find_bounds(const View& view, double now);
  void send_again(Session& session, const StreamList::Row& row);

  InspectionWants wants_, drawn_;
  std::shared_ptr<Document> document_;  // in front of all that refers to it
  vrml::Execution* world_ = nullptr;
  SceneIndex index_;
  SceneOutline outline_;
  EventWatch watch_;
  RouteList routes_;
  ScriptConsole console_;
  StreamList streams_;
  std::unique_ptr<vrml::NodeNames> names_;

  NodeAt selected_;
  bool finds_ = false;  // the first match is to be chosen
  bool reveal_ = false, picking_ = false, fly_ = false, more_ = false, routes_only_ = false;
  std::optional<std::size_t> revealed_, match_;
  render::WorldBounds bounds_;
  NodeAt bounds_of_;
  double bounds_due_ = 0, last_news_ = 0, shown_at_ = 0, clock_ = 0;
  bool news_ = false;
  std::vector<Mark> marks_;
  std::vector<Edit> edits_;
  std::vector<std::string> entered_;
  std::vector<StreamList::Row> retried_;
};

}  // namespace gs::app

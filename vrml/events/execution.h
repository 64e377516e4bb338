#pragma once

#include "vrml/events/event_schema.h"
#include "vrml/events/placement.h"
#include "vrml/events/pointing.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

/// An event that an eventOut or exposedField has sent.
struct SentEvent {
  double time = 0;  // its timestamp: seconds since 1970-01-01 00:00 GMT (VRML97 4.11)
  const SceneGraph* scene = nullptr;
  NodeId node;                                  // of `scene`; of a PROTO instance, its own and those of its body
  const InterfaceDeclaration* event = nullptr;  // of the node's type
  const FieldValue* value = nullptr;
};

/// A node whose fields have changed.
struct NodeChange {
  SceneGraph* scene = nullptr;
  NodeId node;
  std::uint64_t slots = 0;  // a bit for each of the first 63 slots that changed; the last one is for all else
};

class ScriptHost;

/// What an AudioClip or MovieTexture plays (VRML97 6.4, 6.28). Times are seconds since 1970, infinite where there is
/// none.
struct MediaPlay {
  bool active = false, loop = false;
  double start = 0, end = 0;  // of its activity
  double rate = 1;            // pitch or speed
  double duration = -1;       // of the sound or movie at rate 1; negative: not known
  double position = 0;        // in it, in its own seconds: at the present time, or at which it became inactive
};

/// What the viewer sees: tangents of half the angles to the right and up.
struct Frustum {
  double right = 0, up = 0;
};

/// The execution model of VRML97 (4.10, 4.11): ROUTEs, cascades of events, and what nodes do as time goes, for a world
/// and all Inlines attached to it.
///
/// A cascade has one timestamp, and each eventOut sends at most one event in it (4.10.4), so that loops end. Events of
/// one timestamp are delivered in the order in which they were sent, to ROUTEs in the order in which these were made.
/// Work for a step follows what happens in it. Memory is drawn from the scene's budget; what finds no room has no
/// events, and `problem` says so. A cascade of too much work is cut short. One thread, that of the scene; the scene
/// must outlive this.
class Execution {
 public:
  using Observer = std::function<void(const SentEvent&)>;

  explicit Execution(SceneGraph& root);
  ~Execution();
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Takes in what the root and its Inlines have got since the last call: nodes, ROUTEs, bodies of EXTERNPROTOs.
  void attach();
  /// The same of one scene of the world, after vrml::read_into. ROUTEs between nodes made at run time leave
  /// SceneGraph::routes: they are kept here alone.
  void attach(SceneGraph& scene);
  /// A body of EXTERNPROTO instances has come and was attached: bindable nodes of types of which none was bound since
  /// the world began are bound as if they had been there (4.6.10).
  void bind_what_came();
  /// Begins at `now`, with the first cascade: the first bindable node of each type that is not in an Inline is bound
  /// (4.6.10), and time-dependent nodes that are active at that time begin (4.6.9). Call once.
  void start(double now);
  /// Lets time go on to `now`: what time-dependent nodes send, and all that follows from it. Time never goes back.
  void step(double now);
  /// An event from outside, with the present timestamp, and all that follows from it. The value's type must be that
  /// of `event_in`, an eventIn or exposedField of the node's type; false where it is not, where the scene is not
  /// part of the world, or where there is no room.
  bool send(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, const FieldValue& value);

  /// The next events from outside are of a moment of their own, the least bit later than the present, so that each
  /// eventOut may send again (4.10.4). Nodes that run look at the time with the next step.
  void begin_update();
  /// What was posted since is delivered, as one cascade: see `post`.
  void end_update() { drain(); }

  /// False where there is such a ROUTE already (they count once), where it is none between nodes of one scene with
  /// equal types, or where there is no room. Not added to SceneGraph::routes.
  bool add_route(SceneGraph& scene, const Route& route);
  /// False where there is none.
  bool remove_route(SceneGraph& scene, const Route& route);
  /// A ROUTE as events follow it, and the scene of its nodes.
  struct PlacedRoute {
    const SceneGraph* scene = nullptr;
    Route route;
  };
  /// All that there are, of files, PROTO instances, Inlines and programs, in the order in which they were made.
  [[nodiscard]] std::vector<PlacedRoute> placed_routes() const;
  /// Another number whenever there are other ROUTEs than before.
  [[nodiscard]] std::uint64_t routes_revision() const { return routes_revision_; }

  // Nodes made at run time (read_into) are removed when nothing holds them: no field or SFNode or MFNode eventOut of a
  // node that is held, and nobody by `hold`. Nodes of the world's files are held; a PROTO instance and the nodes of its
  // body hold each other; a ROUTE holds its source as long as its target is held, and a target that is a Script as long
  // as its source is, since Scripts act on more than fields. Held nodes keep their names, types and texts.

  /// The node is held, once more with each call, for one who may yet use it, such as a variable of a script.
  void hold(const SceneGraph& scene, NodeId node);
  void release(const SceneGraph& scene, NodeId node);
  /// Removes what nothing holds, now. It happens by itself, too, when a cascade is over and many nodes have been made.
  /// Bound nodes among them are unbound (4.6.10). The number of nodes removed.
  std::size_t remove_unheld();
  /// The Inline shows nothing any more: what it holds is removed, with all Inlines inside, and is in memory only as
  /// long as somebody else has it.
  void remove_content(SceneGraph& scene, NodeId inline_node);
  /// The content of the Inline is another one: to be called behind SceneGraph::attach_inline and `attach`.
  void content_changed(SceneGraph& scene, NodeId inline_node);
  /// In place of the world there are only these nodes of one scene of it, the root's or that of an Inline (4.12.10.8,
  /// replaceWorld), as soon as the cascade is over: what they do not hold is removed, files' nodes as well, and their
  /// first bindable nodes are bound. An Inline's scene is then the only content of the root's. False where one is no
  /// node of the scene, or that is no part of the world.
  bool replace_world(SceneGraph& scene, const MFNode& nodes);
  bool replace_world(const MFNode& nodes) { return replace_world(root_, nodes); }
  /// How often the world has been replaced.
  [[nodiscard]] std::uint32_t replaced() const { return replaced_; }
  /// Is told of each node, or with a null node of a whole scene, before it is removed. Not for work on this object.
  using RemovalObserver = std::function<void(SceneGraph&, NodeId)>;
  void observe_removal(RemovalObserver observer) { removal_observer_ = std::move(observer); }
  /// Whether the scene is the root or the content of an Inline of this world.
  [[nodiscard]] bool has_scene(const SceneGraph* scene) const { return scene_places_.contains(scene); }

  [[nodiscard]] double now() const { return now_; }
  /// When a step has something to do next: at once while nodes run. Nothing: only events from outside go on.
  [[nodiscard]] std::optional<double> next_time() const;
  /// Sees each event when it is delivered, also where no ROUTE leads on. Not for work on this object, nor for changes
  /// of who sees them. One for each `who`; an empty one: `who` sees none any more.
  void observe(Observer observer, const void* who = nullptr) {
    std::erase_if(observers_, [&](const auto& one) { return one.first == who; });
    if (observer) observers_.emplace_back(who, std::move(observer));
  }
  /// The nodes that changed since the last call, each once. Valid until the next step.
  [[nodiscard]] std::span<const NodeChange> take_changes();
  /// The bound node of a bindable type (4.6.10); a null scene: there is none.
  [[nodiscard]] NodeChange bound(const NodeType& type) const;
  /// Whether a bindable node is bound or waits below others to be bound again. Both may be gone.
  [[nodiscard]] bool is_on_stack(const SceneGraph* scene, NodeId node) const;
  [[nodiscard]] bool is_told_viewer() const { return told_viewer_.has_value(); }
  /// Where the viewer is, for sensors: world_from_viewer, without scale. Until it is told, at the bound Viewpoint.
  /// `sees`: empty for the fieldOfView of the bound Viewpoint, and the aspect.
  void set_viewer(const glm::dmat4& world_from_viewer, const std::optional<Frustum>& sees = {}) {
    if (!told_viewer_ || std::exchange(jump_ahead_, false)) ++jumps_;
    told_viewer_ = world_from_viewer;
    told_frustum_ = sees;
  }
  /// The width of the picture, divided by its height.
  void set_aspect(double aspect) { aspect_ = aspect; }
  /// The pointing device was moved, pressed or released: events of its sensors (4.6.7.3), with the present timestamp.
  void point(const Pointer& pointer);
  /// Whether there is a pointing-device sensor at all.
  [[nodiscard]] bool has_pointing_sensors() const { return has_pointing_sensors_; }
  [[nodiscard]] PointedAt pointed_at() const { return pointing_->pointed_at(); }
  /// The enabled pointing-device sensors, and Anchors, that take part where the pointer meets the Shape at the end of
  /// the path (4.6.7.3).
  [[nodiscard]] std::vector<NodePlace> sensors_of(std::span<const PathStep> path) {
    return pointing_->sensors_of(path);
  }
  /// The Anchors that were activated since the last call (6.2): their url is for others to open. The last kMostRequests
  /// at most.
  [[nodiscard]] std::vector<NodePlace> take_requests() { return std::exchange(requests_, {}); }
  static constexpr std::size_t kMostRequests = 64;
  /// The avatar has met the geometry at the end of the path: collideTime of the Collision nodes on it (6.8), with the
  /// present timestamp, unless one of them turns collisions off. False: one does.
  bool collide(std::span<const PathStep> path);
  /// How much of what a QNV node needs has come, 0 to 1, or a PROTO instance with its eventOuts: progress_changed where
  /// that differs by 1/100 from what was sent last, or is all, and loadTime when it is all for the first time since it
  /// was 0, with the present timestamp. False: something was sent with it before; call again after the next step.
  bool progress(const SceneGraph& scene, NodeId node, double fraction);
  /// The sound or movie of a node has come, and is `duration` seconds long; negative: it cannot be had (6.4, 6.28):
  /// duration_changed with the present timestamp, and what follows. False: as of `progress`.
  bool media_came(const SceneGraph& scene, NodeId node, double duration);
  /// Of a node that plays sounds or movies; nothing: it is none.
  [[nodiscard]] std::optional<MediaPlay> media_play(const SceneGraph& scene, NodeId node);
  /// What limits kept out; empty: nothing.
  [[nodiscard]] const std::string& problem() const { return problem_; }

  // For the behaviours of node types. `event` is a place in Behaviour::events.

  template <class T>
  [[nodiscard]] const T& get(EventNode node, int event) const {
    return *std::get_if<T>(&value_of(node, event));
  }
  [[nodiscard]] const FieldValue& value_of(EventNode node, int event) const;
  /// Whether the type of the node has the interface.
  [[nodiscard]] bool has_event(EventNode node, int event) const;
  /// Whether an event was sent already with the present timestamp.
  [[nodiscard]] bool has_sent(EventNode node, int event) const;
  /// Sends an event from an eventOut, or sets an exposedField and sends that.
  template <class T>
  void send(EventNode node, int event, T value) {
    if (FieldValue* place = place_to_send(node, event)) *place = std::move(value);
  }
  /// The same for a value that is made in its place: null where nothing may be sent with this timestamp any more.
  [[nodiscard]] FieldValue* place_to_send(EventNode node, int event);
  [[nodiscard]] const NodeType& type_of(EventNode node) const { return *nodes_[node].schema->type; }
  [[nodiscard]] const SceneGraph& scene_of(EventNode node) const { return *nodes_[node].scene; }
  [[nodiscard]] Node& node_of(EventNode node) { return *nodes_[node].node; }
  /// A number of the node's own, for its behaviour: 0 at first.
  [[nodiscard]] std::uint32_t& state_of(EventNode node) { return nodes_[node].state; }
  /// on_time is called in each step, or no more.
  void run(EventNode node, bool running);
  /// on_time is called once more before this timestamp is over.
  void look_again(EventNode node);
  /// on_time is called in the first step that is not before `time`, and later than the present one. One at a time: a
  /// new one takes the place of the old one.
  void call_at(EventNode node, double time);
  /// The time of the step before this one; the same as now() in the first one.
  [[nodiscard]] double previous() const { return previous_; }
  /// Counts work whose amount a file chooses, in elements. False: too much for one timestamp; leave it.
  [[nodiscard]] bool spend(std::size_t elements);
  [[nodiscard]] bool has_room_for(std::size_t elements) const;
  /// Draws memory from the world's budget.
  [[nodiscard]] bool afford(std::size_t bytes);
  /// The same for a list of the node's own, which has `bytes` now: what exceeds the most that it has had.
  [[nodiscard]] bool afford_most(EventNode node, std::size_t bytes);
  /// The node goes to the top of the stack of its type, or off it (4.6.10).
  void bind(EventNode node, bool to_top);
  /// Nodes are about to leave the children of a node: when the cascade is over, bindable nodes that have left the world
  /// go off their stacks (4.6.10).
  void nodes_leave();
  /// The viewer jumps, now and, where he is told, with the next set_viewer: he does not come by what lies between, and
  /// nodes that run look once more before this timestamp is over (6.53).
  void viewer_jumped();
  /// How often he has jumped.
  [[nodiscard]] std::uint32_t jumps() const { return jumps_; }
  /// The bound node of a type; 0: none.
  [[nodiscard]] EventNode top_of(const NodeType& type) const;

  /// world_from_viewer: as it was told, else of the bound Viewpoint, else 10 units from the origin along z.
  [[nodiscard]] glm::dmat4 viewer();
  /// See Placement. Billboards face the viewer. Valid until this or viewer() is called again.
  [[nodiscard]] std::span<const glm::dmat4> places_of(EventNode node);

  /// What the viewer sees: as it was told, else by the bound Viewpoint, whose fieldOfView is the smaller angle (6.53).
  [[nodiscard]] Frustum frustum() const;
  /// The node in this world; 0 where its scene is no part of it, or there is no room.
  [[nodiscard]] EventNode event_node(const SceneGraph& scene, NodeId node);
  [[nodiscard]] const Behaviour& behaviour_of(EventNode node) const { return *nodes_[node].schema->behaviour; }
  [[nodiscard]] NodePlace place_of(EventNode node) const { return {nodes_[node].scene, nodes_[node].id}; }
  [[nodiscard]] Pointing& pointing() { return *pointing_; }
  /// See take_requests.
  void request(EventNode anchor);

  // For Scripts (VRML97 4.12). `interface`: place in the type's interfaces, of the node's EventSchema.

  /// Who runs the programs of Scripts: of all that are there, from `start` on, and of those that come. Null: nobody. It
  /// must outlive this, or be taken away before it goes; then it is told nothing of the end.
  void set_script_host(ScriptHost* host) { script_host_ = host; }
  [[nodiscard]] ScriptHost* script_host() const { return script_host_; }
  /// Whether there has been a Script.
  [[nodiscard]] bool has_scripts() const { return has_scripts_; }
  [[nodiscard]] const SceneGraph& root() const { return root_; }
  /// The program of the Script, or what it lacked, has come.
  void program_came(const SceneGraph& scene, NodeId script);
  [[nodiscard]] const EventSchema& schema_of_node(EventNode node) const { return *nodes_[node].schema; }
  /// The value of a field, or the last one of an eventOut.
  [[nodiscard]] FieldValue& own_value(EventNode node, std::uint32_t interface) {
    return stored(nodes_[node], nodes_[node].schema->interfaces[interface]);
  }
  /// own_value was changed.
  void own_value_changed(EventNode node, std::uint32_t interface);
  /// An eventOut or exposedField sends the value that own_value has now.
  void send_own(EventNode node, std::uint32_t interface);
  /// An event for a node of this world, from a program that runs: delivered in this cascade behind what has been sent;
  /// or from outside, for end_update.
  /// False as of `send`.
  bool post(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, FieldValue value);
  /// What an eventOut sent last, or what an exposedField or field has; null: no such thing.
  [[nodiscard]] const FieldValue* last_value(const SceneGraph& scene, NodeId node,
                                             const InterfaceDeclaration& interface);
  /// The scene that may be written to, of one that belongs to this world; null: it does not.
  [[nodiscard]] SceneGraph* own_scene(const SceneGraph& scene);
  /// A Script is in the world now.
  void note_script(EventNode node);

  /// State of behaviours, by number; see state_of.
  struct States;
  [[nodiscard]] States& states() { return *states_; }

 private:
  static constexpr std::size_t kDelivery = 16;  // elements of work that the delivery of an event counts

  struct Slot {
    std::uint32_t first = 0, last = 0;  // connections; 0: none
    std::uint64_t sent = 0;             // stamp_ of the last event
  };
  enum class Way : std::uint8_t {
    route,    // to an eventIn
    down,     // of a PROTO instance's eventIn, to that of a node of its body (4.8.2)
    up,       // of an eventOut of a node of the body, to that of the instance
    removed,  // while the cascade lasts that may stand on it
  };
  struct Connection {
    std::uint32_t next = 0, previous = 0;
    std::uint32_t next_in = 0, previous_in = 0;  // of those that lead to `to`
    EventNode source = 0;
    std::uint32_t from = 0;  // slot
    EventNode to = 0;
    std::uint32_t event_in = 0;  // place in the target's interfaces
    Way way = Way::route;
  };
  struct Member {
    SceneGraph* scene = nullptr;
    Node* node = nullptr;
    NodeId id;
    EventSchema* schema = nullptr;
    std::uint32_t first_slot = 0;  // by interface; of PROTO instances the ways down follow
    std::uint32_t first_out = 0;   // of out_values_
    std::uint32_t first_in = 0;    // connections that lead here; 0: none
    std::size_t most = 0;          // bytes, see afford_most
    std::uint32_t state = 0;
    std::uint32_t bound_below = 0, bound_above = 0;  // bindable nodes: the stack of the type
    std::uint32_t change = 0;                        // of changes_, from 1
    std::uint32_t alarm = 0;                         // number of the call_at that counts; 0: none
    bool on_stack = false, running = false, listed = false, looking = false;
    bool placed = false;  // on a stack, and seen in the transformation hierarchy since
    bool refers = false;  // is one of referring_
  };
  struct Sent {
    EventNode node;
    std::uint32_t interface;
    std::uint32_t posted = 0;  // of posted_, from 1: an event for the node, where not 0
  };
  struct Alarm {
    double time;
    EventNode node;
    std::uint32_t number;
    friend bool operator>(const Alarm& a, const Alarm& b) {
      return a.time != b.time ? a.time > b.time : a.node != b.node ? a.node > b.node : a.number > b.number;
    }
  };
  struct SceneState {
    explicit SceneState(SceneGraph* of = nullptr) : scene(of) {}
    SceneGraph* scene = nullptr;     // null: the place is free
    std::vector<EventNode> members;  // by node index
    std::size_t nodes_seen = 1, routes_seen = 0;
    std::vector<NodeId> waiting;      // instances without content
    std::vector<NodeId> at_run_time;  // nodes made then
    bool files_hold = true;           // the nodes of its file are held
    bool lives = false;               // it was attached before: what it gets now comes at run time
  };
  struct NextWorld {
    SceneGraph* scene;
    MFNode nodes;
  };
  struct Stack {
    const NodeType* type;
    EventNode top = 0;
  };

  // execution_attach.cpp
  std::size_t scene_state(SceneGraph& scene);
  void attach_all(std::vector<std::size_t> order);
  void attach_scene(std::size_t index);
  void attach_node(SceneState& state, NodeId id);
  bool attach_instance(SceneState& state, NodeId id);
  EventNode member(SceneState& state, NodeId id);
  EventSchema& schema_of(const NodeType& type);
  std::uint32_t connect(EventNode source, std::uint32_t from, EventNode to, std::uint32_t event_in, Way way);
  void disconnect(std::uint32_t connection);
  void bind_first_nodes(SceneState& state, bool of_fresh_types);
  bool move_to_root(SceneGraph& scene);

  // execution_remove.cpp
  class Marking;
  void note_referring(EventNode node);
  void remove_if_many();
  void remove_nodes(SceneState& state, const std::vector<NodeId>& nodes);
  void remove_scene(SceneGraph& scene);
  void remove_member(EventNode node);
  void drop_removed();
  void do_replace_world();
  struct Ends;
  bool find_ends(SceneGraph& scene, const Route& route, Ends& ends);

  // execution_scripts.cpp
  void begin_scripts();
  /// By value: shutdown() may add nodes, which grows the lists of members.
  void end_scripts(std::vector<EventNode> nodes);

  // execution.cpp
  void begin(double now);
  void drain();
  void deliver(Sent sent);
  void walk(std::uint32_t first, const FieldValue& value);
  void receive(EventNode node, std::uint32_t interface, const FieldValue& value);
  void pass_up(EventNode node, std::uint32_t interface, const FieldValue& value);
  void queue(EventNode node, std::uint32_t interface);
  [[nodiscard]] FieldValue& stored(const Member& at, const EventSchema::Interface& interface);
  NodeChange& change_of(EventNode node);
  void mark_changed(EventNode node, std::int32_t slot);
  Stack& stack_of(const NodeType& type);
  std::vector<EventNode> bindables_on_stacks();
  void unbind_what_left();

  SceneGraph& root_;
  Share share_;
  std::size_t afforded_ = 0;
  std::string problem_;
  std::vector<std::pair<const void*, Observer>> observers_;
  double now_ = 0, previous_ = 0;
  std::uint64_t stamp_ = 1;
  std::size_t work_ = 0;
  bool overloaded_ = false;
  std::vector<Member> nodes_;  // [0] is unused
  std::vector<Slot> slots_;
  std::vector<Connection> connections_;  // [0] is unused
  std::vector<std::uint32_t> free_connections_, removed_connections_;
  // Of removed nodes, to be used again; slots and values by how many there are in a row.
  std::vector<EventNode> free_members_, removed_members_;
  std::unordered_map<std::size_t, std::vector<std::uint32_t>> free_slots_, free_outs_;
  std::vector<std::size_t> free_scenes_;
  std::vector<EventNode> referring_;  // nodes whose fields or eventOuts of nodes have changed
  std::unordered_map<const SceneGraph*, std::unordered_map<std::uint32_t, std::size_t>> held_;  // by index of node
  RemovalObserver removal_observer_;
  std::size_t made_since_ = 0, next_removal_ = 0;  // nodes at run time, since something was removed last
  bool removing_ = false;
  std::optional<NextWorld> next_world_;
  std::uint64_t replaced_at_ = 0;  // the stamp of the moment in which the world was replaced last
  std::uint32_t replaced_ = 0;
  std::deque<FieldValue> out_values_;
  std::unordered_map<std::uint64_t, std::uint32_t> routes_;  // connections by slots from and to
  std::uint64_t routes_revision_ = 0;
  std::unordered_map<const NodeType*, std::unique_ptr<EventSchema>> schemas_;
  std::deque<SceneState> scenes_;
  std::unordered_map<const SceneGraph*, std::size_t> scene_places_;
  std::vector<Sent> queue_;
  std::deque<FieldValue> posted_;
  ScriptHost* script_host_ = nullptr;
  bool has_scripts_ = false, started_ = false, starting_ = false;
  std::vector<EventNode> new_scripts_;
  std::size_t queue_next_ = 0;
  std::vector<std::uint32_t> path_;  // of walk
  std::vector<EventNode> running_, looking_;
  std::vector<Alarm> alarms_;  // a heap, the earliest first
  std::size_t live_alarms_ = 0;
  std::uint32_t alarm_number_ = 0;
  std::vector<Stack> stacks_;
  bool nodes_leave_ = false;
  Placement placement_;
  std::optional<glm::dmat4> told_viewer_;
  std::optional<Frustum> told_frustum_;
  std::uint32_t jumps_ = 0;
  bool jump_ahead_ = false;
  double aspect_ = 4.0 / 3;
  std::unique_ptr<Pointing> pointing_;
  std::vector<NodePlace> requests_;
  bool has_pointing_sensors_ = false;
  std::vector<NodeChange> changes_, taken_changes_;
  std::vector<EventNode> changed_;
  std::unique_ptr<States> states_;
};

}  // namespace gs::vrml

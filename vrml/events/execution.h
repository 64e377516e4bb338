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

/// Event that an eventOut or exposedField has sent.
struct SentEvent {
  double time = 0;  // its timestamp: seconds since 1970-01-01 00:00 GMT (VRML97 4.11)
  const SceneGraph* scene = nullptr;
  NodeId node;  // of `scene`; events of a PROTO instance appear for the instance and for its body nodes
  const InterfaceDeclaration* event = nullptr;  // of the node's type
  const FieldValue* value = nullptr;
};

/// Node with changed fields.
struct NodeChange {
  SceneGraph* scene = nullptr;
  NodeId node;
  std::uint64_t slots = 0;  // bit mask of the changed slots; the last bit stands for all slots above 62
};

class ScriptHost;

/// Playback state of an AudioClip or MovieTexture (VRML97 6.4, 6.28). Times are in seconds since 1970, infinite if
/// undefined.
struct MediaPlay {
  bool active = false, loop = false;
  double start = 0, end = 0;  // of the active period
  double rate = 1;            // pitch or speed
  double duration = -1;       // of the sound or movie at rate 1; negative if unknown
  double position = 0;        // media time in seconds: now, or when it became inactive
};

/// View frustum: tangents of the half angles to the right and up.
struct Frustum {
  double right = 0, up = 0;
};

/// Execution model of VRML97 (4.10, 4.11) for a world and its attached Inlines: ROUTEs, event cascades, time.
///
/// A cascade has one timestamp, and each eventOut sends at most one event per timestamp, which ends loops (4.10.4).
/// Events of one timestamp are delivered in sending order, along ROUTEs in order of creation. The cost of a step is
/// proportional to the events in it. Memory is drawn from the scene's budget; if it is exhausted, further nodes take no
/// part in events and `problem` reports it. Cascades with too much work are cut short. Single-threaded, on the scene's
/// thread; the scene must outlive this.
class Execution {
 public:
  using Observer = std::function<void(const SentEvent&)>;

  explicit Execution(SceneGraph& root);
  ~Execution();
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Takes in the nodes, ROUTEs and EXTERNPROTO bodies that the root and its Inlines gained since the last call.
  void attach();
  /// Takes in additions to one scene of the world, after vrml::read_into. ROUTEs between nodes made at run time move
  /// from SceneGraph::routes into this object.
  void attach(SceneGraph& scene);
  /// Binds nodes from EXTERNPROTO bodies that were loaded and attached later. For each type that has had no bound node
  /// so far, it binds the first one, as at the start (4.6.10).
  void bind_what_came();
  /// Starts at time `now` with the first cascade. Binds the first bindable node of each type outside Inlines (4.6.10)
  /// and starts the time-dependent nodes that are active then (4.6.9). Call once.
  void start(double now);
  /// Advances time to `now` and delivers all resulting events. Time never goes back.
  void step(double now);
  /// Delivers an event from outside with the present timestamp, and all resulting events. The value's type must be that
  /// of `event_in`, an eventIn or exposedField of the node's type. Returns false if it is not, if the scene is not part
  /// of the world, or if the budget is exhausted.
  bool send(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, const FieldValue& value);

  /// Gives the next events from outside a new timestamp, one double ulp later, so that each eventOut may send again
  /// (4.10.4). Running nodes see the new time in the next step.
  void begin_update();
  /// Delivers the events posted since begin_update() as one cascade; see `post`.
  void end_update() { drain(); }

  /// Adds a ROUTE; it does not appear in SceneGraph::routes. Returns false if it exists already, if it does not connect
  /// nodes of one scene with equal types, or if the budget is exhausted.
  bool add_route(SceneGraph& scene, const Route& route);
  /// Returns false if there is no such ROUTE.
  bool remove_route(SceneGraph& scene, const Route& route);
  /// ROUTE that events follow, with the scene of its nodes.
  struct PlacedRoute {
    const SceneGraph* scene = nullptr;
    Route route;
  };
  /// Returns all ROUTEs of files, PROTO instances, Inlines and programs in order of creation.
  [[nodiscard]] std::vector<PlacedRoute> placed_routes() const;
  /// Returns a number that changes whenever ROUTEs are added or removed.
  [[nodiscard]] std::uint64_t routes_revision() const { return routes_revision_; }

  // Lifetime: nodes made at run time (read_into) are removed once nothing holds them. A node is held by a node field or
  // eventOut of a held node, or by `hold`. Nodes of the world's files are held. A PROTO instance and its body nodes
  // hold each other. A ROUTE with a held target holds its source. A ROUTE from a held source holds a Script target,
  // because Scripts act on more than fields. Held nodes keep their names, types and texts.

  /// Holds the node, counted per call, for a user such as a script variable.
  void hold(const SceneGraph& scene, NodeId node);
  void release(const SceneGraph& scene, NodeId node);
  /// Removes unheld nodes now and returns their number. Also runs automatically after a cascade once many nodes were
  /// made. Unbinds bound nodes among them (4.6.10).
  std::size_t remove_unheld();
  /// Removes the content of an Inline, including nested Inlines. The memory is freed when the last owner releases it.
  void remove_content(SceneGraph& scene, NodeId inline_node);
  /// Updates to new content of an Inline. Call it after SceneGraph::attach_inline and `attach`.
  void content_changed(SceneGraph& scene, NodeId inline_node);
  /// Replaces the world by these nodes of one of its scenes, the root or an Inline (4.12.10.8, replaceWorld), once the
  /// cascade ends. Removes all nodes that these do not hold, including file nodes, and binds their first bindable
  /// nodes. An Inline's scene becomes the only content of the root. Returns false if a node is not in the scene, or the
  /// scene is not in the world.
  bool replace_world(SceneGraph& scene, const MFNode& nodes);
  bool replace_world(const MFNode& nodes) { return replace_world(root_, nodes); }
  /// Returns the number of replacements of the world.
  [[nodiscard]] std::uint32_t replaced() const { return replaced_; }
  /// Called before each node is removed; a null node stands for the whole scene. It must not modify this object.
  using RemovalObserver = std::function<void(SceneGraph&, NodeId)>;
  void observe_removal(RemovalObserver observer) { removal_observer_ = std::move(observer); }
  /// Reports whether the scene is the root or the content of an Inline of this world.
  [[nodiscard]] bool has_scene(const SceneGraph* scene) const { return scene_places_.contains(scene); }

  [[nodiscard]] double now() const { return now_; }
  /// Returns the time of the next step with work: now() while nodes run; nullopt if only events from outside cause
  /// work.
  [[nodiscard]] std::optional<double> next_time() const;
  /// Registers an observer that receives each event at delivery, even without a ROUTE. One observer per key `who`; an
  /// empty one unregisters. Observers must neither modify this object nor register observers.
  void observe(Observer observer, const void* who = nullptr) {
    std::erase_if(observers_, [&](const auto& one) { return one.first == who; });
    if (observer) observers_.emplace_back(who, std::move(observer));
  }
  /// Returns the nodes changed since the last call, each once. Valid until the next step.
  [[nodiscard]] std::span<const NodeChange> take_changes();
  /// Returns the bound node of a bindable type (4.6.10); null scene if there is none.
  [[nodiscard]] NodeChange bound(const NodeType& type) const;
  /// Reports whether a bindable node is on its type's stack. Accepts a scene and a node that were removed.
  [[nodiscard]] bool is_on_stack(const SceneGraph* scene, NodeId node) const;
  [[nodiscard]] bool is_told_viewer() const { return told_viewer_.has_value(); }
  /// Sets the viewer for sensors: world_from_viewer, without scale. Before the first call, the bound Viewpoint applies.
  /// If `sees` is empty, the frustum follows from the bound Viewpoint's fieldOfView and the aspect ratio.
  void set_viewer(const glm::dmat4& world_from_viewer, const std::optional<Frustum>& sees = {}) {
    if (!told_viewer_ || std::exchange(jump_ahead_, false)) ++jumps_;
    told_viewer_ = world_from_viewer;
    told_frustum_ = sees;
  }
  /// Sets the aspect ratio of the image: width divided by height.
  void set_aspect(double aspect) { aspect_ = aspect; }
  /// Handles a move, press or release of the pointing device: sends sensor events (4.6.7.3) with the present timestamp.
  void point(const Pointer& pointer);
  /// Reports whether the world has a pointing-device sensor.
  [[nodiscard]] bool has_pointing_sensors() const { return has_pointing_sensors_; }
  [[nodiscard]] PointedAt pointed_at() const { return pointing_->pointed_at(); }
  /// Returns the enabled pointing-device sensors and Anchors that act if the pointer hits the Shape at the end of the
  /// path (4.6.7.3).
  [[nodiscard]] std::vector<NodePlace> sensors_of(std::span<const PathStep> path) {
    return pointing_->sensors_of(path);
  }
  /// Returns and clears the Anchors activated since the last call (6.2), at most kMostRequests. The caller opens their
  /// URLs.
  [[nodiscard]] std::vector<NodePlace> take_requests() { return std::exchange(requests_, {}); }
  static constexpr std::size_t kMostRequests = 64;
  /// Reports a collision of the avatar with the geometry at the end of the path: sends collideTime of its Collision
  /// nodes (6.8) with the present timestamp. Returns false if one of them has collision detection off.
  bool collide(std::span<const PathStep> path);
  /// Reports the received fraction, 0 to 1, of a QNV node's data (or of a PROTO instance with its eventOuts). Sends
  /// progress_changed if the fraction differs by at least 1/100 from the last one sent or reaches 1; sends loadTime
  /// when it first reaches 1 after 0. Returns false if one was already sent with this timestamp; call again after the
  /// next step.
  bool progress(const SceneGraph& scene, NodeId node, double fraction);
  /// Reports that the sound or movie of a node has loaded; `duration` is in seconds, negative if loading failed (6.4,
  /// 6.28). Sends duration_changed. Returns false if it was already sent with this timestamp; call again after the next
  /// step.
  bool media_came(const SceneGraph& scene, NodeId node, double duration);
  /// Returns the playback state of a node; nullopt if it plays no sound or movie.
  [[nodiscard]] std::optional<MediaPlay> media_play(const SceneGraph& scene, NodeId node);
  /// Returns a message about what the limits excluded; empty if nothing was.
  [[nodiscard]] const std::string& problem() const { return problem_; }

  // Functions for the behaviours of node types. `event` is an index in Behaviour::events.

  template <class T>
  [[nodiscard]] const T& get(EventNode node, int event) const {
    return *std::get_if<T>(&value_of(node, event));
  }
  [[nodiscard]] const FieldValue& value_of(EventNode node, int event) const;
  /// Reports whether the node's type has the interface.
  [[nodiscard]] bool has_event(EventNode node, int event) const;
  /// Reports whether the event was already sent with the present timestamp.
  [[nodiscard]] bool has_sent(EventNode node, int event) const;
  /// Sends an eventOut, or sets an exposedField and sends its value.
  template <class T>
  void send(EventNode node, int event, T value) {
    if (FieldValue* place = place_to_send(node, event)) *place = std::move(value);
  }
  /// Returns storage for a value to send in place; null if the eventOut was already sent with this timestamp.
  [[nodiscard]] FieldValue* place_to_send(EventNode node, int event);
  [[nodiscard]] const NodeType& type_of(EventNode node) const { return *nodes_[node].schema->type; }
  [[nodiscard]] const SceneGraph& scene_of(EventNode node) const { return *nodes_[node].scene; }
  [[nodiscard]] Node& node_of(EventNode node) { return *nodes_[node].node; }
  /// Returns a number that the node's behaviour may use; initially 0.
  [[nodiscard]] std::uint32_t& state_of(EventNode node) { return nodes_[node].state; }
  /// Turns calls of on_time in each step on or off.
  void run(EventNode node, bool running);
  /// Requests one more call of on_time with this timestamp.
  void look_again(EventNode node);
  /// Requests a call of on_time in the first step at or after `time`, later than the present step. Each node has one
  /// such request; a new one replaces it.
  void call_at(EventNode node, double time);
  /// Returns the time of the previous step; equal to now() in the first step.
  [[nodiscard]] double previous() const { return previous_; }
  /// Counts work that grows with file content, in elements. Returns false if the limit per timestamp is reached; the
  /// caller must then skip the work.
  [[nodiscard]] bool spend(std::size_t elements);
  [[nodiscard]] bool has_room_for(std::size_t elements) const;
  /// Draws memory from the world's budget.
  [[nodiscard]] bool afford(std::size_t bytes);
  /// Draws memory for a list of the node that now has `bytes` bytes: only the excess over its largest size so far.
  [[nodiscard]] bool afford_most(EventNode node, std::size_t bytes);
  /// Moves the node to the top of its type's stack, or removes it from the stack (4.6.10).
  void bind(EventNode node, bool to_top);
  /// Announces that nodes leave a grouping node. After the cascade, bindable nodes outside the world leave their stacks
  /// (4.6.10).
  void nodes_leave();
  /// Reports a jump of the viewer. It holds now and, if set_viewer() is in use, for its next call. The viewer does not
  /// pass positions in between; running nodes are evaluated once more with this timestamp (6.53).
  void viewer_jumped();
  /// Returns the number of viewer jumps.
  [[nodiscard]] std::uint32_t jumps() const { return jumps_; }
  /// Returns the bound node of a type; 0 if none.
  [[nodiscard]] EventNode top_of(const NodeType& type) const;

  /// Returns world_from_viewer: from set_viewer(), else of the bound Viewpoint, else 10 units from the origin along +Z.
  [[nodiscard]] glm::dmat4 viewer();
  /// See Placement::places_of. Billboards face the viewer. Valid until the next call of this or of viewer().
  [[nodiscard]] std::span<const glm::dmat4> places_of(EventNode node);

  /// Returns the frustum: from set_viewer(), else by the bound Viewpoint; its fieldOfView is the smaller angle (6.53).
  [[nodiscard]] Frustum frustum() const;
  /// Returns the node's index; 0 if its scene is not part of the world or the budget is exhausted.
  [[nodiscard]] EventNode event_node(const SceneGraph& scene, NodeId node);
  [[nodiscard]] const Behaviour& behaviour_of(EventNode node) const { return *nodes_[node].schema->behaviour; }
  [[nodiscard]] NodePlace place_of(EventNode node) const { return {nodes_[node].scene, nodes_[node].id}; }
  [[nodiscard]] Pointing& pointing() { return *pointing_; }
  /// See take_requests.
  void request(EventNode anchor);

  // Functions for Scripts (VRML97 4.12). `interface` is an index in the interfaces of the node's EventSchema.

  /// Sets the host that runs the programs of present and future Scripts, from `start` on. Null means none. The host
  /// must outlive this object, or be unset first; an unset host receives no end() calls.
  void set_script_host(ScriptHost* host) { script_host_ = host; }
  [[nodiscard]] ScriptHost* script_host() const { return script_host_; }
  /// Reports whether the world has ever had a Script.
  [[nodiscard]] bool has_scripts() const { return has_scripts_; }
  [[nodiscard]] const SceneGraph& root() const { return root_; }
  /// Reports that the Script's program, or a resource that it lacked, has loaded.
  void program_came(const SceneGraph& scene, NodeId script);
  [[nodiscard]] const EventSchema& schema_of_node(EventNode node) const { return *nodes_[node].schema; }
  /// Returns the value of a field, or the last value of an eventOut.
  [[nodiscard]] FieldValue& own_value(EventNode node, std::uint32_t interface) {
    return stored(nodes_[node], nodes_[node].schema->interfaces[interface]);
  }
  /// Reports a change made through own_value().
  void own_value_changed(EventNode node, std::uint32_t interface);
  /// Sends the present own_value() of an eventOut or exposedField.
  void send_own(EventNode node, std::uint32_t interface);
  /// Queues an event for a node of this world. From a running program, it is delivered in this cascade after the events
  /// already sent; from outside, by end_update(). Returns false like `send`.
  bool post(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, FieldValue value);
  /// Returns the last value of an eventOut, or the value of a field; null if there is none.
  [[nodiscard]] const FieldValue* last_value(const SceneGraph& scene, NodeId node,
                                             const InterfaceDeclaration& interface);
  /// Returns the mutable scene if it belongs to this world, else null.
  [[nodiscard]] SceneGraph* own_scene(const SceneGraph& scene);
  /// Registers a Script that entered the world.
  void note_script(EventNode node);

  /// State of behaviours, indexed by state_of.
  struct States;
  [[nodiscard]] States& states() { return *states_; }

 private:
  static constexpr std::size_t kDelivery = 16;  // work elements counted per delivered event

  struct Slot {
    std::uint32_t first = 0, last = 0;  // connections; 0 means none
    std::uint64_t sent = 0;             // stamp_ of the last event
  };
  enum class Way : std::uint8_t {
    route,    // to an eventIn
    down,     // from an eventIn of a PROTO instance to that of a body node (4.8.2)
    up,       // from an eventOut of a body node to that of the instance
    removed,  // kept until the cascade ends, since its path may contain it
  };
  struct Connection {
    std::uint32_t next = 0, previous = 0;
    std::uint32_t next_in = 0, previous_in = 0;  // list of the connections that lead to `to`
    EventNode source = 0;
    std::uint32_t from = 0;  // slot
    EventNode to = 0;
    std::uint32_t event_in = 0;  // index in the target's interfaces
    Way way = Way::route;
  };
  struct Member {
    SceneGraph* scene = nullptr;
    Node* node = nullptr;
    NodeId id;
    EventSchema* schema = nullptr;
    std::uint32_t first_slot = 0;  // by interface; for PROTO instances, the slots of the `down` connections follow
    std::uint32_t first_out = 0;   // index in out_values_
    std::uint32_t first_in = 0;    // first connection that leads here; 0 means none
    std::size_t most = 0;          // largest size in bytes; see afford_most
    std::uint32_t state = 0;
    std::uint32_t bound_below = 0, bound_above = 0;  // neighbours on the type's stack (bindable nodes)
    std::uint32_t change = 0;                        // index in changes_, from 1
    std::uint32_t alarm = 0;                         // number of the valid call_at request; 0 means none
    bool on_stack = false, running = false, listed = false, looking = false;
    bool placed = false;  // on a stack, and found in the transformation hierarchy since then
    bool refers = false;  // listed in referring_
  };
  struct Sent {
    EventNode node;
    std::uint32_t interface;
    std::uint32_t posted = 0;  // if not 0: index from 1 in posted_, an event for the node
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
    SceneGraph* scene = nullptr;     // null if the entry is free
    std::vector<EventNode> members;  // by node index
    std::size_t nodes_seen = 1, routes_seen = 0;
    std::vector<NodeId> waiting;      // instances without content
    std::vector<NodeId> at_run_time;  // nodes made at run time
    bool files_hold = true;           // the nodes of its file are held
    bool lives = false;               // attached before: additions count as made at run time
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
  // Entries of removed nodes for reuse; slots and values are keyed by run length.
  std::vector<EventNode> free_members_, removed_members_;
  std::unordered_map<std::size_t, std::vector<std::uint32_t>> free_slots_, free_outs_;
  std::vector<std::size_t> free_scenes_;
  std::vector<EventNode> referring_;  // nodes with changed node fields or eventOuts
  // Counts of `hold`, by node index.
  std::unordered_map<const SceneGraph*, std::unordered_map<std::uint32_t, std::size_t>> held_;
  RemovalObserver removal_observer_;
  std::size_t made_since_ = 0, next_removal_ = 0;  // counts of run-time nodes since the last removal
  bool removing_ = false;
  std::optional<NextWorld> next_world_;
  std::uint64_t replaced_at_ = 0;  // stamp_ of the last replacement
  std::uint32_t replaced_ = 0;
  std::deque<FieldValue> out_values_;
  std::unordered_map<std::uint64_t, std::uint32_t> routes_;  // connections by source and target slot
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
  std::vector<std::uint32_t> path_;  // used by walk
  std::vector<EventNode> running_, looking_;
  std::vector<Alarm> alarms_;  // heap, earliest first
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

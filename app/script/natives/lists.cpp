#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/contained.h"
#include "app/script/bounds/field_memory.h"
#include "app/script/natives.h"
#include "app/script/natives/live_proxy.h"
#include "app/script/script_world.h"
#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/printer.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/MemoryFunctions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>
#include <js/Proxy.h>
#include <js/RealmOptions.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <type_traits>
#include <utility>

// The MF types (VRML97 C.6.10 to C.6.18). The list of a Script's own field or eventOut stores no value; it reads and
// writes the field. Every other list stores a value. If it was read from a node and changed, its value is sent to that
// node at the end of the function.
namespace gs::app::script {
namespace {

using vrml::FieldType;
using vrml::FieldValue;

constexpr std::size_t kListParentSlot = 0, kListPlaceSlot = 1;
constexpr std::uint32_t kMaxElements = 1U << 26, kMaxNodes = 1U << 20;
constexpr std::size_t kMaxPrinted = std::size_t{1} << 20;  // max elements of a list that is converted to text

bool index_of(jsid id, std::uint32_t& index) {
  if (!id.isInt() || id.toInt() < 0) return false;
  index = static_cast<std::uint32_t>(id.toInt());
  return true;
}

bool is_length(JSContext* context, jsid id) {
  if (!id.isString()) return false;
  bool same = false;
  return JS_StringEqualsLiteral(context, id.toString(), "length", &same) && same;
}

std::size_t count_of(const FieldValue& value) {
  return std::visit(
      [](const auto& array) -> std::size_t {
        if constexpr (requires { array.span(); }) return array.size();
        return 0;
      },
      value);
}

void release(ListBox& box) {
  for (const vrml::NodeId id : box.held) box.link->release({box.scene, id});
  box.held.clear();
}

// Adds `change` to the bytes that the list counts against the heap of programs.
void count(ListBox& box, std::ptrdiff_t change) {
  if (!box.engine) return;
  std::size_t& counted = box.program ? box.program->counted[box.place] : box.counted;
  change = std::max(change, -static_cast<std::ptrdiff_t>(counted));
  counted += static_cast<std::size_t>(change);
  box.engine->add_bytes(change);
}

// Holds the nodes of a list, so that they are not removed.
void keep(ListBox& box) {
  if (box.program) return;
  if (const auto* nodes = std::get_if<vrml::MFNode>(&box.value); nodes && box.link->lives(box.scene)) {
    const std::vector<vrml::NodeId> before = std::exchange(box.held, {nodes->begin(), nodes->end()});
    for (const vrml::NodeId id : box.held) box.link->hold({box.scene, id});
    for (const vrml::NodeId id : before) box.link->release({box.scene, id});
  }
}

using vrml::element_type;

// Returns the bytes of the text or the pixels of an element, which are not part of the array.
std::size_t outer_bytes(const FieldValue& list, std::size_t index) {
  if (const auto* const texts = std::get_if<vrml::MFString>(&list)) return (*texts)[index].view().size();
  if (const auto* const images = std::get_if<vrml::MFImage>(&list))
    return (*images)[index].words.size() * sizeof(std::uint32_t);
  return 0;
}

class ListHandler : public LiveProxyHandler {
 public:
  constexpr ListHandler() : LiveProxyHandler(&kFamily) {}
  static constexpr char kFamily = 'L';

  void finalize(JS::GCContext*, JSObject* proxy) const override {
    auto* const box = static_cast<ListBox*>(js::GetProxyPrivate(proxy).toPrivate());
    release(*box);
    if (box->engine) box->engine->add_bytes(-static_cast<std::ptrdiff_t>(box->counted));
    delete box;
  }
  bool ownPropertyKeys(JSContext* context, JS::HandleObject proxy, JS::MutableHandleIdVector keys) const override {
    const FieldValue* const value = list_value(*list_of(proxy));
    const std::size_t count = value ? count_of(*value) : 0;
    for (std::size_t i = 0; i < count; ++i)
      if (!keys.append(jsid::Int(static_cast<std::int32_t>(i)))) return false;
    (void)context;
    return true;
  }
  bool getOwnPropertyDescriptor(JSContext* context, JS::HandleObject proxy, JS::HandleId id,
                                JS::MutableHandle<mozilla::Maybe<JS::PropertyDescriptor>> found) const override {
    found.reset();
    std::uint32_t index = 0;
    const FieldValue* const value = list_value(*list_of(proxy));
    const bool length = is_length(context, id);
    if (!value || !(length || (index_of(id, index) && index < count_of(*value)))) return true;
    JS::RootedValue element(context), receiver(context, JS::ObjectValue(*proxy));
    if (!get(context, proxy, receiver, id, &element)) return false;
    JS::PropertyAttributes attributes{JS::PropertyAttribute::Writable};
    if (!length) attributes += {JS::PropertyAttribute::Enumerable, JS::PropertyAttribute::Configurable};
    found.set(mozilla::Some(JS::PropertyDescriptor::Data(element, attributes)));
    return true;
  }
  bool has(JSContext* context, JS::HandleObject proxy, JS::HandleId id, bool* found) const override {
    std::uint32_t index = 0;
    const FieldValue* const value = list_value(*list_of(proxy));
    if (index_of(id, index)) {
      *found = value && index < count_of(*value);
      return true;
    }
    if (is_length(context, id)) {
      *found = true;
      return true;
    }
    return has_inherited(context, proxy, id, found);
  }
  bool get(JSContext* context, JS::HandleObject proxy, JS::HandleValue receiver, JS::HandleId id,
           JS::MutableHandleValue result) const override {
    std::uint32_t index = 0;
    ListBox& box = *list_of(proxy);
    const FieldValue* const value = list_value(box);
    if (index_of(id, index)) return element(context, proxy, box, value, index, result);
    if (is_length(context, id)) {
      result.setNumber(static_cast<double>(value ? count_of(*value) : 0));
      return true;
    }
    return get_inherited(context, proxy, id, receiver, result);
  }
  bool set(JSContext* context, JS::HandleObject proxy, JS::HandleId id, JS::HandleValue value, JS::HandleValue,
           JS::ObjectOpResult& result) const override {
    std::uint32_t index = 0;
    if (index_of(id, index)) return set_element(context, proxy, index, value) && result.succeed();
    if (!is_length(context, id)) return result.succeed();  // a list has no other properties
    double length = 0;
    if (!JS::ToNumber(context, value, &length)) return false;
    if (!(length >= 0 && length <= kMaxElements)) return fail(context, "invalid length of a list");
    return resize(context, proxy, static_cast<std::uint32_t>(length)) && result.succeed();
  }

  static bool resize(JSContext* context, JS::HandleObject proxy, std::uint32_t length) {
    ListBox& box = *list_of(proxy);
    FieldValue* const value = list_value(box);
    if (!value) return true;
    const std::size_t before = block_bytes_of(*value) + text_bytes_of(*value, length);
    if (!change_size(context, *value, length)) return false;
    count(box, static_cast<std::ptrdiff_t>(block_bytes_of(*value)) - static_cast<std::ptrdiff_t>(before));
    return changed(context, proxy, box);
  }

  static bool change_size(JSContext* context, FieldValue& value, std::uint32_t length) {
    return std::visit(
        [&](auto& array) {
          if constexpr (requires { array.span(); }) {
            const std::size_t before = array.size();
            if (std::is_same_v<std::decay_t<decltype(array[0])>, vrml::NodeId> && length > kMaxNodes)
              return fail_range(context, "a list of nodes may have " + std::to_string(kMaxNodes) + " elements");
            const std::size_t bytes = length * sizeof(*array.data());
            if (length > before && (length > kMaxElements || !world_of(context).engine().may_have(bytes))) {
              JS_ReportOutOfMemory(context);
              return false;
            }
            // Reserve more than the requested length, because lists are often filled element by element.
            if (length > array.capacity()) array.reserve(std::max<std::size_t>(length, array.capacity() * 3 / 2 + 4));
            array.resize(length);
            if constexpr (requires { typename std::decay_t<decltype(array[0])>::col_type; })
              for (std::size_t i = before; i < length; ++i)
                array.mutable_data()[i] = std::decay_t<decltype(array[0])>(1);
          }
          return true;
        },
        value);
  }

  static bool changed(JSContext* context, JS::HandleObject proxy, ListBox& box) {
    if (box.program) {
      box.program->world->calls().own_changed(*box.program, box.place);
      return true;
    }
    keep(box);
    const JS::Value& parent = js::GetProxyReservedSlot(proxy, kListParentSlot);
    if (!parent.isObject() || std::exchange(box.changed, true)) return true;
    return world_of(context).calls().changed().add(context, proxy);
  }

 private:
  bool element(JSContext* context, JS::HandleObject proxy, const ListBox& box, const FieldValue* value,
               std::uint32_t index, JS::MutableHandleValue result) const {
    if (!value || index >= count_of(*value)) {
      // Return a new element beyond the end. Assigning a component of it extends the list (C.6.10.1).
      const FieldType of = value ? element_type(vrml::type_of(*value)) : FieldType::SFNode;
      if (vrml::number_count(of) > 1)
        return to_value(context, box.scene, vrml::initial_value(of), {proxy, index}, result);
      result.setUndefined();
      return true;
    }
    return std::visit(
        [&](const auto& array) {
          if constexpr (requires { array.span(); }) {
            using T = std::decay_t<decltype(array[0])>;
            if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, vrml::Double>) {
              result.set(JS::NumberValue(static_cast<double>(array[index])));
              return true;
            } else if constexpr (std::is_same_v<T, std::int32_t>) {
              result.setInt32(array[index]);
              return true;
            } else {
              return to_value(context, box.scene, vrml::single_value_of(array[index]), {proxy, index}, result);
            }
          } else {
            return false;
          }
        },
        *value);
  }
};

constexpr char ListHandler::kFamily;
const ContainedHandler<ListHandler> kListHandler;

std::uint64_t scene_of_caller(JSContext* context) { return world_of(context).calls().running().scene(); }

constexpr FieldType type_at(int index) { return static_cast<FieldType>(vrml::kSingleTypeCount + index); }

template <int kIndex>
bool construct(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  ListBox box;
  box.scene = scene_of_caller(context);
  box.value = vrml::initial_value(type_at(kIndex));
  JS::RootedObject list(context, make_list(context, std::move(box), {}));
  if (!list) return false;
  JS::RootedValue element(context);
  JS::RootedObject source(context);
  std::uint32_t count = args.length();
  // If the only argument is a list or array, copy its elements.
  if (count == 1 && args[0].isObject()) {
    bool is_array = false;
    JS::RootedObject object(context, &args[0].toObject());
    if (!JS::IsArrayObject(context, object, &is_array)) return false;
    if (is_array || list_of(object)) {
      source = object;
      JS::RootedValue length(context);
      double number = 0;
      if (!JS_GetProperty(context, object, "length", &length) || !JS::ToNumber(context, length, &number)) return false;
      count = static_cast<std::uint32_t>(std::min<double>(number, kMaxElements));
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (source) {
      if (!JS_GetElement(context, source, i, &element)) return false;
    } else {
      element = args[i];
    }
    if (!element.isUndefined() && !set_element(context, list, i, element)) return false;
    if (i % 4096 == 4095 && !JS_CheckForInterrupt(context)) return false;
  }
  args.rval().setObject(*list);
  return true;
}

bool list_to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  ListBox* const box = args.thisv().isObject() ? list_of(&args.thisv().toObject()) : nullptr;
  if (!box) return fail(context, "called on a value that is not a list");
  std::string text;
  static const vrml::SceneGraph nothing;
  const FieldValue* const value = list_value(*box);
  if (value && count_of(*value) > kMaxPrinted)
    return fail_range(context, "a list of " + std::to_string(count_of(*value)) + " elements is too long for a string");
  // The text contains names of nodes, which the world knows. It omits nodes that the program may not read.
  if (value && std::holds_alternative<vrml::MFNode>(*value) && box->link->lives(box->scene)) {
    Question question{Ask::print_nodes, {box->scene, {}}};
    question.value = *value;
    text = world_of(context).view().ask(question).text;
  } else if (value) {
    vrml::print_value(text, *value, nothing);
  }
  return make_string(context, text, args.rval());
}

const JSFunctionSpec kListMethods[] = {JS_FN("toString", contained<list_to_text>, 0, 0), JS_FS_END};

template <int kIndex>
bool define(JSContext* context, JS::HandleObject library, JS::HandleObject array_prototype,
            std::vector<JS::PersistentRootedObject>& prototypes) {
  const char* const name = vrml::name_of(type_at(kIndex)).data();
  JS::RootedObject prototype(context, JS_NewObjectWithGivenProto(context, nullptr, array_prototype));
  JSFunction* const function = JS_NewFunction(context, contained<construct<kIndex>>, 0, JSFUN_CONSTRUCTOR, name);
  JS::RootedObject constructor(context, function ? JS_GetFunctionObject(function) : nullptr);
  if (!prototype || !constructor || !JS_DefineFunctions(context, prototype, kListMethods)) return false;
  if (!JS_LinkConstructorAndPrototype(context, constructor, prototype)) return false;
  prototypes[static_cast<std::size_t>(type_at(kIndex))] = prototype;
  return JS_DefineProperty(context, library, name, constructor, 0);
}

template <int... kIndices>
bool define_all(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes,
                std::integer_sequence<int, kIndices...>) {
  JS::RootedObject array_prototype(context, JS::GetRealmArrayPrototype(context));
  return array_prototype && (define<kIndices>(context, library, array_prototype, prototypes) && ...);
}

}  // namespace

bool define_lists(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes) {
  return define_all(context, library, prototypes, std::make_integer_sequence<int, vrml::kSingleTypeCount>());
}

ListBox* list_of(JSObject* object) {
  if (!js::IsProxy(object) || js::GetProxyHandler(object) != &kListHandler) return nullptr;
  return static_cast<ListBox*>(js::GetProxyPrivate(object).toPrivate());
}

FieldValue* list_value(ListBox& box) {
  if (!box.program) return &box.value;
  return &box.program->values[box.place];
}

JSObject* make_list(JSContext* context, ListBox box, Source source) {
  ScriptLibrary& library = library_of(context);
  World& world = *library.world;
  JS::RootedObject parent(context, source.parent);
  const FieldType type = box.program ? box.program->interface(box.place).type : vrml::type_of(box.value);
  auto own = std::make_unique<ListBox>(std::move(box));
  own->link = library.link;
  own->engine = &world.engine();
  own->type = type;
  JS::RootedValue place(context, JS::PrivateValue(own.get()));
  JSObject* const made = js::NewProxyObject(context, &kListHandler, place, library.prototype(type));
  if (!made) return nullptr;
  ListBox& kept = *own.release();
  js::SetProxyReservedSlot(made, kListParentSlot, parent ? JS::ObjectValue(*parent) : JS::UndefinedValue());
  js::SetProxyReservedSlot(made, kListPlaceSlot, JS::Int32Value(static_cast<std::int32_t>(source.place)));
  keep(kept);
  if (!kept.program) count(kept, static_cast<std::ptrdiff_t>(bytes_of(kept.value)));
  return made;
}

bool set_element(JSContext* context, JS::HandleObject list, std::uint32_t index, JS::HandleValue value) {
  ListBox& box = *list_of(list);
  FieldValue* field = list_value(box);
  if (!field) return true;
  FieldValue element;
  if (!to_field(context, value, element_type(vrml::type_of(*field)), box.scene, element)) return false;
  field = list_value(box);  // the conversion may have run code that changed the list
  const bool is_new = index >= count_of(*field);
  const std::size_t outer =
      std::holds_alternative<vrml::SFImage>(element) || std::holds_alternative<vrml::SFString>(element)
          ? bytes_of(element)
          : 0;
  if (outer > 0 && !world_of(context).engine().may_have(outer)) {
    JS_ReportOutOfMemory(context);
    return false;
  }
  std::size_t before = block_bytes_of(*field);
  if (!is_new) before += outer_bytes(*field, index);
  if (is_new) {
    if (index >= kMaxElements) return fail(context, "index exceeds the maximum length of a list");
    if (!ListHandler::change_size(context, *field, index + 1)) return false;
  }
  std::visit(
      [&](auto& array) {
        if constexpr (requires { array.span(); }) {
          using T = std::decay_t<decltype(array[0])>;
          array.mutable_data()[index] = vrml::element_in(*std::get_if<vrml::SingleValue<T>>(&element));
        }
      },
      *field);
  count(box, static_cast<std::ptrdiff_t>(block_bytes_of(*field) + outer) - static_cast<std::ptrdiff_t>(before));
  return ListHandler::changed(context, list, box);
}

void forget_program_of_list(ListBox& box) {
  box.value = vrml::initial_value(box.type);
  box.program = nullptr;
}

bool flush_list(JSContext* context, JS::HandleObject list) {
  ListBox& box = *list_of(list);
  if (!std::exchange(box.changed, false)) return true;
  const JS::Value parent = js::GetProxyReservedSlot(list, kListParentSlot);
  if (!parent.isObject()) return true;
  JS::RootedObject source(context, &parent.toObject());
  JS::RootedValue value(context, JS::ObjectValue(*list));
  return write_back(context, source,
                    static_cast<std::uint32_t>(js::GetProxyReservedSlot(list, kListPlaceSlot).toInt32()), value);
}

}  // namespace gs::app::script

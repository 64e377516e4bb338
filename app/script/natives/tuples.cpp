#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/natives/tuple_numbers.h"
#include "app/script/script_world.h"
#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/printer.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

// SFColor (VRML97 C.6.4), SFRotation (C.6.7), SFVec2f (C.6.8), SFVec3f (C.6.9), and the tuples of X3D, with components
// in double precision. If the object was read from a field, an eventOut or a list, assigning a component writes it back
// there.
namespace gs::app::script {
namespace {

using vrml::FieldType;

constexpr std::uint32_t kParentSlot = 4, kPlaceSlot = 5, kTupleSlots = 6;

struct TupleKind {
  FieldType type;
  int count;
  JSClass of;
};
constexpr JSClass class_named(const char* name) {
  return {name, JSCLASS_HAS_RESERVED_SLOTS(kTupleSlots), nullptr, nullptr, nullptr, nullptr};
}
const TupleKind kKinds[] = {
    {FieldType::SFColor, 3, class_named("SFColor")},         {FieldType::SFRotation, 4, class_named("SFRotation")},
    {FieldType::SFVec2f, 2, class_named("SFVec2f")},         {FieldType::SFVec3f, 3, class_named("SFVec3f")},
    {FieldType::SFColorRGBA, 4, class_named("SFColorRGBA")}, {FieldType::SFVec2d, 2, class_named("SFVec2d")},
    {FieldType::SFVec3d, 3, class_named("SFVec3d")},         {FieldType::SFVec4f, 4, class_named("SFVec4f")},
    {FieldType::SFVec4d, 4, class_named("SFVec4d")},
};

const TupleKind* kind_of(JSObject* object) {
  const JSClass* const of = JS::GetClass(object);
  for (const TupleKind& kind : kKinds)
    if (of == &kind.of) return &kind;
  return nullptr;
}

const TupleKind& kind_of(FieldType type) {
  return *std::find_if(std::begin(kKinds), std::end(kKinds), [&](const TupleKind& one) { return one.type == type; });
}

// Returns the kind of the object on which a method was called, and its components in `c`. Throws an exception and
// returns null for another object.
const TupleKind* this_tuple(JSContext* context, const JS::CallArgs& args, double* c) {
  if (args.thisv().isObject()) {
    JSObject* const object = &args.thisv().toObject();
    if (const TupleKind* const kind = kind_of(object)) {
      for (int i = 0; i < kind->count; ++i)
        c[i] = JS::GetReservedSlot(object, static_cast<std::uint32_t>(i)).toNumber();
      return kind;
    }
  }
  (void)fail(context, "called on an object of another type");
  return nullptr;
}

// Reads a vector argument into `c`, which has room for 4 components. `type` is the type of an array of numbers.
bool vector_argument(JSContext* context, const JS::CallArgs& args, unsigned index, double* c,
                     FieldType type = FieldType::SFVec3f) {
  FieldType found{};
  if (args.get(index).isObject() && is_tuple(&args.get(index).toObject(), found, c)) return true;
  vrml::FieldValue field;
  if (!to_field(context, args.get(index), type, 0, field)) return false;
  vrml::read_numbers(field, c);
  return true;
}

bool number_argument(JSContext* context, const JS::CallArgs& args, unsigned index, double& number) {
  if (index >= args.length()) {
    number = 0;
    return true;
  }
  return JS::ToNumber(context, args[index], &number);
}

bool give(JSContext* context, const JS::CallArgs& args, FieldType type, const double* c) {
  JSObject* const made = make_tuple(context, type, c);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

// Sets the components of an object and writes the object back to its origin.
bool put(JSContext* context, JS::HandleObject object, int count, const double* c) {
  for (int i = 0; i < count; ++i) JS::SetReservedSlot(object, static_cast<std::uint32_t>(i), JS::DoubleValue(c[i]));
  const JS::Value parent = JS::GetReservedSlot(object, kParentSlot);
  if (!parent.isObject()) return true;
  JS::RootedObject source(context, &parent.toObject());
  JS::RootedValue value(context, JS::ObjectValue(*object));
  return write_back(context, source, static_cast<std::uint32_t>(JS::GetReservedSlot(object, kPlaceSlot).toInt32()),
                    value);
}

template <int kIndex>
bool get_component(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (!args.thisv().isObject() || !kind_of(&args.thisv().toObject())) {
    args.rval().setUndefined();
    return true;
  }
  (void)context;
  const double number = JS::GetReservedSlot(&args.thisv().toObject(), kIndex).toNumber();
  args.rval().set(JS::NumberValue(number));
  return true;
}

template <int kIndex>
bool set_component(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  const TupleKind* const kind = this_tuple(context, args, c);
  if (!kind || !number_argument(context, args, 0, c[kIndex])) return false;
  JS::RootedObject object(context, &args.thisv().toObject());
  args.rval().setUndefined();
  return put(context, object, kind->count, c);
}

bool tuple_to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  const TupleKind* const kind = this_tuple(context, args, c);
  if (!kind) return false;
  std::string text;
  static const vrml::SceneGraph nothing;
  vrml::FieldValue value = vrml::initial_value(kind->type);
  vrml::write_numbers(value, c);
  vrml::print_value(text, value, nothing);
  return make_string(context, text, args.rval());
}

// ---- Methods

template <class Combine>
bool combine(JSContext* context, unsigned argc, JS::Value* vp, const Combine& with) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double a[4] = {}, b[4] = {};
  const TupleKind* const kind = this_tuple(context, args, a);
  if (!kind) return false;
  if (!args.get(0).isObject()) return fail(context, "expected an object of the same type");
  if (!vector_argument(context, args, 0, b, kind->type)) return false;
  for (int i = 0; i < kind->count; ++i) a[i] = with(a[i], b[i]);
  return give(context, args, kind->type, a);
}

bool add(JSContext* context, unsigned argc, JS::Value* vp) {
  return combine(context, argc, vp, [](double a, double b) { return a + b; });
}
bool subtract(JSContext* context, unsigned argc, JS::Value* vp) {
  return combine(context, argc, vp, [](double a, double b) { return a - b; });
}

template <class Scale>
bool scale(JSContext* context, unsigned argc, JS::Value* vp, const Scale& by) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  const TupleKind* const kind = this_tuple(context, args, c);
  double number = 1;
  if (!kind || !number_argument(context, args, 0, number)) return false;
  for (int i = 0; i < kind->count; ++i) c[i] = by(c[i], number);
  return give(context, args, kind->type, c);
}

bool multiply(JSContext* context, unsigned argc, JS::Value* vp) {
  return scale(context, argc, vp, [](double a, double n) { return a * n; });
}
bool divide(JSContext* context, unsigned argc, JS::Value* vp) {
  return scale(context, argc, vp, [](double a, double n) { return a / n; });
}
bool negate(JSContext* context, unsigned argc, JS::Value* vp) {
  return scale(context, argc, vp, [](double a, double) { return -a; });
}

double length_of(const double* c, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += c[i] * c[i];
  return std::sqrt(sum);
}

bool length(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  const TupleKind* const kind = this_tuple(context, args, c);
  if (!kind) return false;
  args.rval().set(JS::NumberValue(length_of(c, kind->count)));
  return true;
}

bool normalize(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  const TupleKind* const kind = this_tuple(context, args, c);
  if (!kind) return false;
  const double size = length_of(c, kind->count);
  for (int i = 0; i < kind->count; ++i) c[i] = size > 0 ? c[i] / size : 0;
  return give(context, args, kind->type, c);
}

bool dot(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double a[4] = {}, b[4] = {};
  const TupleKind* const kind = this_tuple(context, args, a);
  if (!kind || !vector_argument(context, args, 0, b, kind->type)) return false;
  double sum = 0;
  for (int i = 0; i < kind->count; ++i) sum += a[i] * b[i];
  args.rval().set(JS::NumberValue(sum));
  return true;
}

bool cross(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double a[4] = {}, b[4] = {};
  const TupleKind* const kind = this_tuple(context, args, a);
  if (!kind || !vector_argument(context, args, 0, b)) return false;
  const double c[] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return give(context, args, kind->type, c);
}

// ---- SFColor

// Implements setHSV(). The hue is 0 to 1, as in Cosmo Player; the standard does not define its range.
bool set_hsv(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {}, hsv[3] = {};
  if (!this_tuple(context, args, c)) return false;
  for (unsigned i = 0; i < 3; ++i)
    if (!number_argument(context, args, i, hsv[i])) return false;
  rgb_of(hsv[0], hsv[1], hsv[2], c);
  JS::RootedObject object(context, &args.thisv().toObject());
  args.rval().setUndefined();
  return put(context, object, 3, c);
}

bool get_hsv(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {}, hsv[3] = {};
  if (!this_tuple(context, args, c)) return false;
  hsv_of(c, hsv);
  JS::RootedValueArray<3> numbers(context);
  for (std::size_t i = 0; i < 3; ++i) numbers[i].set(JS::NumberValue(hsv[i]));
  JSObject* const array = JS::NewArrayObject(context, numbers);
  args.rval().setObjectOrNull(array);
  return array != nullptr;
}

// ---- SFRotation

bool get_axis(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  return this_tuple(context, args, c) && give(context, args, FieldType::SFVec3f, c);
}

bool set_axis(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {}, axis[4] = {};
  if (!this_tuple(context, args, c) || !vector_argument(context, args, 0, axis)) return false;
  std::copy(axis, axis + 3, c);
  JS::RootedObject object(context, &args.thisv().toObject());
  args.rval().setUndefined();
  return put(context, object, 4, c);
}

bool inverse_rotation(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {};
  if (!this_tuple(context, args, c)) return false;
  c[3] = -c[3];
  return give(context, args, FieldType::SFRotation, c);
}

bool rotation_argument(JSContext* context, const JS::CallArgs& args, double* c) {
  FieldType type{};
  if (args.get(0).isObject() && is_tuple(&args[0].toObject(), type, c) && type == FieldType::SFRotation) return true;
  return fail(context, "expected an SFRotation");
}

// Implements multiply(). Applies this rotation first, then the argument, because vectors are rows, as with VrmlMatrix.
bool multiply_rotation(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double a[4] = {}, b[4] = {};
  if (!this_tuple(context, args, a) || !rotation_argument(context, args, b)) return false;
  rotation_of(quaternion(b) * quaternion(a), a);
  return give(context, args, FieldType::SFRotation, a);
}

bool rotate_vector(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double c[4] = {}, v[4] = {};
  if (!this_tuple(context, args, c) || !vector_argument(context, args, 0, v)) return false;
  const glm::dvec3 turned = quaternion(c) * glm::dvec3(v[0], v[1], v[2]);
  const double result[] = {turned.x, turned.y, turned.z};
  return give(context, args, FieldType::SFVec3f, result);
}

bool slerp(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double a[4] = {}, b[4] = {}, t = 0;
  if (!this_tuple(context, args, a) || !rotation_argument(context, args, b) || !number_argument(context, args, 1, t))
    return false;
  if (t <= 0) return give(context, args, FieldType::SFRotation, a);
  if (t >= 1) return give(context, args, FieldType::SFRotation, b);
  rotation_of(glm::slerp(quaternion(a), quaternion(b), t), a);
  return give(context, args, FieldType::SFRotation, a);
}

// ---- Constructors

template <int kIndexOfKind>
bool construct_tuple(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  const TupleKind& kind = kKinds[kIndexOfKind];
  double c[4] = {};
  if (kind.type == FieldType::SFRotation) {
    c[1] = 1;  // "missing values default to 0.0, except y, which defaults to 1.0" (C.6.7.2)
    FieldType type{};
    double first[4] = {}, second[4] = {};
    if (args.length() >= 1 && args[0].isObject() && is_tuple(&args[0].toObject(), type, first)) {
      if (type == FieldType::SFRotation) return give(context, args, kind.type, first);
      std::copy(first, first + 3, c);
      if (args.length() >= 2 && args[1].isObject()) {
        if (!vector_argument(context, args, 1, second)) return false;
        const glm::dvec3 from(first[0], first[1], first[2]), to(second[0], second[1], second[2]);
        glm::dvec3 axis = glm::cross(from, to);
        const double sine = glm::length(axis), cosine = glm::dot(from, to);
        // For opposite vectors, take any axis at right angles to them.
        if (!(sine > 0))
          axis = cosine < 0 ? glm::cross(from, std::abs(from.x) < 0.9 * glm::length(from) ? glm::dvec3(1, 0, 0)
                                                                                          : glm::dvec3(0, 1, 0))
                            : glm::dvec3(0, 0, 1);
        const double size = glm::length(axis);
        for (int i = 0; i < 3; ++i) c[i] = size > 0 ? axis[i] / size : i == 2;
        c[3] = std::atan2(sine, cosine);
      } else if (!number_argument(context, args, 1, c[3])) {
        return false;
      }
      return give(context, args, kind.type, c);
    }
  } else if (args.length() == 1 && args[0].isObject()) {
    FieldType type{};
    if (is_tuple(&args[0].toObject(), type, c)) return give(context, args, kind.type, c);
  }
  for (unsigned i = 0; i < static_cast<unsigned>(kind.count) && i < args.length(); ++i)
    if (!number_argument(context, args, i, c[i])) return false;
  return give(context, args, kind.type, c);
}

const JSPropertySpec kColorNumbers[] = {
    JS_PSGS("r", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("g", contained<get_component<1>>, contained<set_component<1>>, kProperty),
    JS_PSGS("b", contained<get_component<2>>, contained<set_component<2>>, kProperty), JS_PS_END};
const JSPropertySpec kRotationNumbers[] = {
    JS_PSGS("x", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("y", contained<get_component<1>>, contained<set_component<1>>, kProperty),
    JS_PSGS("z", contained<get_component<2>>, contained<set_component<2>>, kProperty),
    JS_PSGS("angle", contained<get_component<3>>, contained<set_component<3>>, kProperty), JS_PS_END};
const JSPropertySpec kVec2fNumbers[] = {
    JS_PSGS("x", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("y", contained<get_component<1>>, contained<set_component<1>>, kProperty), JS_PS_END};
const JSPropertySpec kVec3fNumbers[] = {
    JS_PSGS("x", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("y", contained<get_component<1>>, contained<set_component<1>>, kProperty),
    JS_PSGS("z", contained<get_component<2>>, contained<set_component<2>>, kProperty), JS_PS_END};
const JSPropertySpec kColorRGBANumbers[] = {
    JS_PSGS("r", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("g", contained<get_component<1>>, contained<set_component<1>>, kProperty),
    JS_PSGS("b", contained<get_component<2>>, contained<set_component<2>>, kProperty),
    JS_PSGS("a", contained<get_component<3>>, contained<set_component<3>>, kProperty), JS_PS_END};
const JSPropertySpec kVec4Numbers[] = {
    JS_PSGS("x", contained<get_component<0>>, contained<set_component<0>>, kProperty),
    JS_PSGS("y", contained<get_component<1>>, contained<set_component<1>>, kProperty),
    JS_PSGS("z", contained<get_component<2>>, contained<set_component<2>>, kProperty),
    JS_PSGS("w", contained<get_component<3>>, contained<set_component<3>>, kProperty), JS_PS_END};
const JSFunctionSpec kColorMethods[] = {JS_FN("setHSV", contained<set_hsv>, 3, 0),
                                        JS_FN("getHSV", contained<get_hsv>, 0, 0),
                                        JS_FN("toString", contained<tuple_to_text>, 0, 0), JS_FS_END};
const JSFunctionSpec kRotationMethods[] = {
    JS_FN("getAxis", contained<get_axis>, 0, 0),           JS_FN("inverse", contained<inverse_rotation>, 0, 0),
    JS_FN("multiply", contained<multiply_rotation>, 1, 0), JS_FN("multVec", contained<rotate_vector>, 1, 0),
    JS_FN("setAxis", contained<set_axis>, 1, 0),           JS_FN("slerp", contained<slerp>, 2, 0),
    JS_FN("toString", contained<tuple_to_text>, 0, 0),     JS_FS_END};
const JSFunctionSpec kVectorMethods[] = {JS_FN("add", contained<add>, 1, 0),
                                         JS_FN("divide", contained<divide>, 1, 0),
                                         JS_FN("dot", contained<dot>, 1, 0),
                                         JS_FN("length", contained<length>, 0, 0),
                                         JS_FN("multiply", contained<multiply>, 1, 0),
                                         JS_FN("negate", contained<negate>, 0, 0),
                                         JS_FN("normalize", contained<normalize>, 0, 0),
                                         JS_FN("subtract", contained<subtract>, 1, 0),
                                         JS_FN("toString", contained<tuple_to_text>, 0, 0),
                                         JS_FS_END};
const JSFunctionSpec kVec3fMethods[] = {JS_FN("cross", contained<cross>, 1, 0),
                                        JS_FS_END};  // in addition to kVectorMethods

template <int kIndex>
bool define_index(JSContext* context, JS::HandleObject prototype) {
  JSFunction* const get = JS_NewFunction(context, contained<get_component<kIndex>>, 0, 0, nullptr);
  JS::RootedObject getter(context, get ? JS_GetFunctionObject(get) : nullptr);
  JSFunction* const set = JS_NewFunction(context, contained<set_component<kIndex>>, 1, 0, nullptr);
  JS::RootedObject setter(context, set ? JS_GetFunctionObject(set) : nullptr);
  return getter && setter && JS_DefineElement(context, prototype, kIndex, getter, setter, JSPROP_PERMANENT);
}

template <int kIndexOfKind>
bool define(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes,
            const JSPropertySpec* numbers, const JSFunctionSpec* methods, const JSFunctionSpec* more = nullptr) {
  const TupleKind& kind = kKinds[kIndexOfKind];
  JS::RootedObject prototype(context,
                             JS_InitClass(context, library, nullptr, &kind.of, construct_tuple<kIndexOfKind>,
                                          static_cast<unsigned>(kind.count), numbers, methods, nullptr, nullptr));
  if (!prototype || (more && !JS_DefineFunctions(context, prototype, more))) return false;
  if (!define_index<0>(context, prototype) || !define_index<1>(context, prototype)) return false;
  if (kind.count > 2 && !define_index<2>(context, prototype)) return false;
  if (kind.count > 3 && !define_index<3>(context, prototype)) return false;
  for (std::uint32_t i = 0; i < 4; ++i) JS::SetReservedSlot(prototype, i, JS::DoubleValue(0));
  prototypes[static_cast<std::size_t>(kind.type)] = prototype;
  return true;
}

}  // namespace

JSObject* make_tuple(JSContext* context, FieldType type, const double* components, Source source) {
  const TupleKind& kind = kind_of(type);
  JS::RootedObject parent(context, source.parent);
  JS::RootedObject prototype(context, library_of(context).prototype(type));
  JSObject* const made = JS_NewObjectWithGivenProto(context, &kind.of, prototype);
  if (!made) return nullptr;
  for (int i = 0; i < kind.count; ++i)
    JS::SetReservedSlot(made, static_cast<std::uint32_t>(i), JS::DoubleValue(components[i]));
  JS::SetReservedSlot(made, kParentSlot, parent ? JS::ObjectValue(*parent) : JS::UndefinedValue());
  JS::SetReservedSlot(made, kPlaceSlot, JS::Int32Value(static_cast<std::int32_t>(source.place)));
  return made;
}

bool is_tuple(JSObject* object, FieldType& type, double* components) {
  const TupleKind* const kind = kind_of(object);
  if (!kind) return false;
  type = kind->type;
  for (int i = 0; i < kind->count; ++i)
    components[i] = JS::GetReservedSlot(object, static_cast<std::uint32_t>(i)).toNumber();
  return true;
}

bool define_tuples(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes) {
  return define<0>(context, library, prototypes, kColorNumbers, kColorMethods) &&
         define<1>(context, library, prototypes, kRotationNumbers, kRotationMethods) &&
         define<2>(context, library, prototypes, kVec2fNumbers, kVectorMethods) &&
         define<3>(context, library, prototypes, kVec3fNumbers, kVectorMethods, kVec3fMethods) &&
         define<4>(context, library, prototypes, kColorRGBANumbers, kColorMethods) &&
         define<5>(context, library, prototypes, kVec2fNumbers, kVectorMethods) &&
         define<6>(context, library, prototypes, kVec3fNumbers, kVectorMethods, kVec3fMethods) &&
         define<7>(context, library, prototypes, kVec4Numbers, kVectorMethods) &&
         define<8>(context, library, prototypes, kVec4Numbers, kVectorMethods);
}

}  // namespace gs::app::script

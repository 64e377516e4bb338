#include "app/script/natives.h"
#include "app/script/script_world.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <array>
#include <charconv>
#include <cmath>

// VrmlMatrix (VRML97 C.6.19): four rows of numbers, with the translation in the fourth row; vectors are rows. A glm
// matrix, in which vectors are columns, stores the same numbers in the same order.
namespace gs::app::script {
namespace {

constexpr std::uint32_t kNumbers = 16;
// A matrix of 3 rows takes the upper left part of 4 rows; kSizeSlot is the number of its rows.
constexpr std::uint32_t kSizeSlot = kNumbers, kMatrixParentSlot = kSizeSlot + 1,
                        kMatrixPlaceSlot = kMatrixParentSlot + 1;
constexpr std::uint32_t kMatrixSlots = kMatrixPlaceSlot + 1;
const JSClass kMatrixClass = {"VrmlMatrix", JSCLASS_HAS_RESERVED_SLOTS(kMatrixSlots), nullptr, nullptr, nullptr,
                              nullptr};
const JSClass kRowClass = {"VrmlMatrixRow", JSCLASS_HAS_RESERVED_SLOTS(2), nullptr, nullptr, nullptr, nullptr};

bool is_matrix(const JS::Value& value) { return value.isObject() && JS::GetClass(&value.toObject()) == &kMatrixClass; }

glm::dmat4 matrix_of(JSObject* object) {
  glm::dmat4 matrix;
  for (std::uint32_t i = 0; i < kNumbers; ++i)
    matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = JS::GetReservedSlot(object, i).toNumber();
  return matrix;
}

void set_matrix(JSObject* object, const glm::dmat4& matrix) {
  for (std::uint32_t i = 0; i < kNumbers; ++i)
    JS::SetReservedSlot(object, i, JS::DoubleValue(matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)]));
}

int size_of(JSObject* object) { return JS::GetReservedSlot(object, kSizeSlot).toInt32(); }

JSObject* make(JSContext* context, const glm::dmat4& matrix, int size) {
  JS::RootedObject prototype(context, library_of(context).matrix_prototype());
  JSObject* const made = JS_NewObjectWithGivenProto(context, &kMatrixClass, prototype);
  if (!made) return nullptr;
  set_matrix(made, matrix);
  JS::SetReservedSlot(made, kSizeSlot, JS::Int32Value(size));
  return made;
}

// Returns a matrix of the size of the called one; 4 rows for a constructor.
bool give(JSContext* context, const JS::CallArgs& args, const glm::dmat4& matrix) {
  const int size = is_matrix(args.thisv()) ? size_of(&args.thisv().toObject()) : 4;
  JSObject* const made = make(context, matrix, size);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

// Writes a changed matrix back to the object from which it was read.
bool matrix_changed(JSContext* context, JS::HandleObject matrix) {
  const JS::Value parent = JS::GetReservedSlot(matrix, kMatrixParentSlot);
  if (!parent.isObject()) return true;
  JS::RootedObject source(context, &parent.toObject());
  JS::RootedValue value(context, JS::ObjectValue(*matrix));
  return write_back(context, source,
                    static_cast<std::uint32_t>(JS::GetReservedSlot(matrix, kMatrixPlaceSlot).toInt32()), value);
}

bool this_matrix(JSContext* context, const JS::CallArgs& args, glm::dmat4& matrix) {
  if (!is_matrix(args.thisv())) return fail(context, "called on a value that is not a VrmlMatrix");
  matrix = matrix_of(&args.thisv().toObject());
  return true;
}

bool numbers_of(JSContext* context, JS::HandleValue value, vrml::FieldType type, double* c) {
  vrml::FieldType found{};
  if (value.isObject() && is_tuple(&value.toObject(), found, c) && found == type) return true;
  vrml::FieldValue field;
  if (!to_field(context, value, type, nullptr, field)) return false;
  if (type == vrml::FieldType::SFRotation) {
    const auto& r = std::get<vrml::SFRotation>(field);
    c[0] = r.x, c[1] = r.y, c[2] = r.z, c[3] = r.angle;
  } else {
    const auto& v = std::get<vrml::SFVec3f>(field);
    c[0] = v.x, c[1] = v.y, c[2] = v.z;
  }
  return true;
}

glm::dmat4 turn(const double* c) {
  const glm::dvec3 axis(c[0], c[1], c[2]);
  return glm::length(axis) > 0 ? glm::rotate(glm::dmat4(1), c[3], glm::normalize(axis)) : glm::dmat4(1);
}

// Sets the matrix from the fields of a Transform (6.52). Trailing arguments may be missing.
bool set_transform(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 ignored;
  if (!this_matrix(context, args, ignored)) return false;
  using vrml::FieldType;
  constexpr FieldType kTypes[] = {FieldType::SFVec3f, FieldType::SFRotation, FieldType::SFVec3f, FieldType::SFRotation,
                                  FieldType::SFVec3f};
  double c[5][4] = {{0, 0, 0, 0}, {0, 0, 1, 0}, {1, 1, 1, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}};
  for (unsigned i = 0; i < 5 && i < args.length(); ++i)
    if (!args[i].isNullOrUndefined() && !numbers_of(context, args[i], kTypes[i], c[i])) return false;
  const glm::dvec3 translation(c[0][0], c[0][1], c[0][2]), scale(c[2][0], c[2][1], c[2][2]);
  const glm::dvec3 center(c[4][0], c[4][1], c[4][2]);
  const glm::dmat4 one(1), orientation = turn(c[3]);
  const glm::dmat4 matrix = glm::translate(one, translation) * glm::translate(one, center) * turn(c[1]) * orientation *
                            glm::scale(one, scale) * glm::transpose(orientation) * glm::translate(one, -center);
  JS::RootedObject object(context, &args.thisv().toObject());
  set_matrix(object, matrix);
  args.rval().setUndefined();
  return matrix_changed(context, object);
}

bool assign(JSContext* context, JS::HandleValue target, const double* c, unsigned count) {
  if (!target.isObject()) return true;
  JS::RootedObject object(context, &target.toObject());
  for (std::uint32_t i = 0; i < count; ++i) {
    JS::RootedValue number(context, JS::DoubleValue(c[i]));
    if (!JS_SetElement(context, object, i, number)) return false;
  }
  return true;
}

// Computes the fields of a Transform. Ignores shear. A mirrored matrix gives negative scale factors.
bool get_transform(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  if (!this_matrix(context, args, matrix)) return false;
  glm::dvec3 axes[3], scale;
  for (int i = 0; i < 3; ++i) axes[i] = glm::dvec3(matrix[i]);
  const double sign = glm::dot(glm::cross(axes[0], axes[1]), axes[2]) < 0 ? -1 : 1;
  for (int i = 0; i < 3; ++i) {
    scale[i] = sign * glm::length(axes[i]);
    axes[i] = scale[i] != 0 ? axes[i] / scale[i] : glm::dvec3(i == 0, i == 1, i == 2);
  }
  // Make the axes orthogonal, which removes any shear.
  axes[1] -= axes[0] * glm::dot(axes[0], axes[1]);
  if (glm::length(axes[1]) > 0) axes[1] = glm::normalize(axes[1]);
  axes[2] = glm::cross(axes[0], axes[1]);
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(axes[0], axes[1], axes[2])));
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  const glm::dvec3 axis = size > 0 ? v / size : glm::dvec3(0, 0, 1);
  const double translation[] = {matrix[3][0], matrix[3][1], matrix[3][2]};
  const double rotation[] = {axis.x, axis.y, axis.z, 2 * std::atan2(size, q.w)};
  const double scales[] = {scale.x, scale.y, scale.z};
  args.rval().setUndefined();
  return assign(context, args.get(0), translation, 3) && assign(context, args.get(1), rotation, 4) &&
         assign(context, args.get(2), scales, 3);
}

bool inverse_matrix(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  return this_matrix(context, args, matrix) && give(context, args, glm::inverse(matrix));
}

bool transpose(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  return this_matrix(context, args, matrix) && give(context, args, glm::transpose(matrix));
}

template <bool kLeft>
bool mult(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  if (!this_matrix(context, args, matrix)) return false;
  if (!is_matrix(args.get(0))) return fail(context, "expected a VrmlMatrix");
  const glm::dmat4 other = matrix_of(&args[0].toObject());
  // The order is reversed, because rows of a VrmlMatrix are columns in glm.
  return give(context, args, kLeft ? matrix * other : other * matrix);
}

// Multiplies the matrix by a vector. The vector is a row on the left if kRow, else a column on the right.
template <bool kRow>
bool mult_vec(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  double c[4] = {};
  if (!this_matrix(context, args, matrix)) return false;
  if (!numbers_of(context, args.get(0), vrml::FieldType::SFVec3f, c)) return false;
  const glm::dvec4 point(c[0], c[1], c[2], 1), result = kRow ? matrix * point : point * matrix;
  const double w = result.w != 0 ? result.w : 1;
  const double numbers[] = {result.x / w, result.y / w, result.z / w};
  JSObject* const made = make_tuple(context, vrml::FieldType::SFVec3f, numbers);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

bool matrix_to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  if (!this_matrix(context, args, matrix)) return false;
  std::string text;
  const int size = size_of(&args.thisv().toObject());
  for (int i = 0; i < size * size; ++i) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, static_cast<float>(matrix[i / size][i % size])).ptr;
    text += (i ? " " : "") + std::string(digits, end);
  }
  return make_string(context, text, args.rval());
}

bool construct_matrix(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix(1);
  if (is_matrix(args.get(0))) return give(context, args, matrix_of(&args[0].toObject()));
  for (unsigned i = 0; i < kNumbers && i < args.length(); ++i) {
    double number = 0;
    if (!JS::ToNumber(context, args[i], &number)) return false;
    matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = number;
  }
  return give(context, args, matrix);
}

// ---- matrix[row][column]

template <int kColumn>
bool get_number(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (!args.thisv().isObject() || JS::GetClass(&args.thisv().toObject()) != &kRowClass)
    return fail(context, "called on a value that is not a row of a VrmlMatrix");
  JSObject* const row = &args.thisv().toObject();
  const JS::Value matrix = JS::GetReservedSlot(row, 0);
  if (!matrix.isObject()) return fail(context, "called on a value that is not a row of a VrmlMatrix");
  args.rval().set(JS::GetReservedSlot(&matrix.toObject(),
                                      static_cast<std::uint32_t>(JS::GetReservedSlot(row, 1).toInt32() * 4 + kColumn)));
  return true;
}

template <int kColumn>
bool set_number(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  double number = 0;
  if (!args.thisv().isObject() || JS::GetClass(&args.thisv().toObject()) != &kRowClass)
    return fail(context, "called on a value that is not a row of a VrmlMatrix");
  JS::RootedObject row(context, &args.thisv().toObject());
  if (!JS::ToNumber(context, args.get(0), &number)) return false;
  const JS::Value matrix = JS::GetReservedSlot(row, 0);
  args.rval().setUndefined();
  if (!matrix.isObject()) return true;
  JS::RootedObject object(context, &matrix.toObject());
  JS::SetReservedSlot(object, static_cast<std::uint32_t>(JS::GetReservedSlot(row, 1).toInt32() * 4 + kColumn),
                      JS::DoubleValue(number));
  return matrix_changed(context, object);
}

template <int kRow>
bool get_row(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  if (!is_matrix(args.thisv())) return fail(context, "called on a value that is not a VrmlMatrix");
  JS::RootedObject prototype(context, library_of(context).row_prototype());
  JSObject* const row = JS_NewObjectWithGivenProto(context, &kRowClass, prototype);
  if (!row) return false;
  JS::SetReservedSlot(row, 0, args.thisv());
  JS::SetReservedSlot(row, 1, JS::Int32Value(kRow));
  args.rval().setObject(*row);
  return true;
}

bool define_element(JSContext* context, JS::HandleObject prototype, std::uint32_t index, JSNative get, JSNative set) {
  JSFunction* const getter = JS_NewFunction(context, get, 0, 0, nullptr);
  JS::RootedObject get_object(context, getter ? JS_GetFunctionObject(getter) : nullptr);
  JSFunction* const setter = set ? JS_NewFunction(context, set, 1, 0, nullptr) : nullptr;
  JS::RootedObject set_object(context, setter ? JS_GetFunctionObject(setter) : nullptr);
  return get_object && JS_DefineElement(context, prototype, index, get_object, set_object, JSPROP_PERMANENT);
}

const JSFunctionSpec kMatrixMethods[] = {
    JS_FN("setTransform", set_transform, 5, 0),   JS_FN("getTransform", get_transform, 3, 0),
    JS_FN("inverse", inverse_matrix, 0, 0),       JS_FN("transpose", transpose, 0, 0),
    JS_FN("multLeft", mult<true>, 1, 0),          JS_FN("multRight", mult<false>, 1, 0),
    JS_FN("multVecMatrix", mult_vec<true>, 1, 0), JS_FN("multMatrixVec", mult_vec<false>, 1, 0),
    JS_FN("toString", matrix_to_text, 0, 0),      JS_FS_END};

}  // namespace

JSObject* make_matrix(JSContext* context, int count, const double* numbers, Source source) {
  const int size = count == 9 ? 3 : 4;
  glm::dmat4 matrix(1);
  for (int i = 0; i < count; ++i) matrix[i / size][i % size] = numbers[i];
  JS::RootedObject parent(context, source.parent);
  JSObject* const made = make(context, matrix, size);
  if (!made) return nullptr;
  JS::SetReservedSlot(made, kMatrixParentSlot, parent ? JS::ObjectValue(*parent) : JS::UndefinedValue());
  JS::SetReservedSlot(made, kMatrixPlaceSlot, JS::Int32Value(static_cast<std::int32_t>(source.place)));
  return made;
}

bool numbers_of_matrix(JSObject* object, int count, double* numbers) {
  if (JS::GetClass(object) != &kMatrixClass || size_of(object) != (count == 9 ? 3 : 4)) return false;
  const glm::dmat4 matrix = matrix_of(object);
  const int size = size_of(object);
  for (int i = 0; i < count; ++i) numbers[i] = matrix[i / size][i % size];
  return true;
}

bool define_matrices(JSContext* context, JS::HandleObject library,
                     std::vector<JS::PersistentRootedObject>& prototypes) {
  JS::RootedObject prototype(context, JS_InitClass(context, library, nullptr, &kMatrixClass, construct_matrix, 16,
                                                   nullptr, kMatrixMethods, nullptr, nullptr));
  JS::RootedObject row(context, JS_NewPlainObject(context));
  if (!prototype || !row) return false;
  set_matrix(prototype, glm::dmat4(1));
  JS::SetReservedSlot(prototype, kSizeSlot, JS::Int32Value(4));
  prototypes[ScriptLibrary::kMatrixPrototype] = prototype;
  prototypes[ScriptLibrary::kRowPrototype] = row;
  return define_element(context, prototype, 0, get_row<0>, nullptr) &&
         define_element(context, prototype, 1, get_row<1>, nullptr) &&
         define_element(context, prototype, 2, get_row<2>, nullptr) &&
         define_element(context, prototype, 3, get_row<3>, nullptr) &&
         define_element(context, row, 0, get_number<0>, set_number<0>) &&
         define_element(context, row, 1, get_number<1>, set_number<1>) &&
         define_element(context, row, 2, get_number<2>, set_number<2>) &&
         define_element(context, row, 3, get_number<3>, set_number<3>);
}

}  // namespace gs::app::script

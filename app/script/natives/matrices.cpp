#include "app/script/bounds/contained.h"
#include "app/script/natives.h"
#include "app/script/script_world.h"
#include "vrml/scene/values/field_numbers.h"

#include <js/Array.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/PropertySpec.h>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

// VrmlMatrix (VRML97 C.6.19) and the matrices of X3D: three or four rows of numbers, with the translation in the fourth
// row; vectors are rows. A glm matrix, in which vectors are columns, stores the same numbers in the same order.
namespace gs::app::script {
namespace {

constexpr std::uint32_t kNumbers = 16;
// A matrix of 3 rows takes the upper left part of 4 rows. kKindSlot is the index of its MatrixKind.
constexpr std::uint32_t kKindSlot = kNumbers, kMatrixParentSlot = kKindSlot + 1,
                        kMatrixPlaceSlot = kMatrixParentSlot + 1;
constexpr std::uint32_t kMatrixSlots = kMatrixPlaceSlot + 1;
struct MatrixKind {
  const char* name;
  int size;              // number of rows
  vrml::FieldType type;  // type of a field with this matrix
};
constexpr MatrixKind kMatrixKinds[] = {
    {"VrmlMatrix", 4, vrml::FieldType::SFMatrix4f}, {"SFMatrix3f", 3, vrml::FieldType::SFMatrix3f},
    {"SFMatrix3d", 3, vrml::FieldType::SFMatrix3d}, {"SFMatrix4f", 4, vrml::FieldType::SFMatrix4f},
    {"SFMatrix4d", 4, vrml::FieldType::SFMatrix4d},
};
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

int kind_of_matrix(JSObject* object) { return JS::GetReservedSlot(object, kKindSlot).toInt32(); }
int size_of(JSObject* object) { return kMatrixKinds[kind_of_matrix(object)].size; }

JSObject* make(JSContext* context, const glm::dmat4& matrix, int kind) {
  const ScriptLibrary& library = library_of(context);
  JS::RootedObject prototype(context,
                             kind == 0 ? library.matrix_prototype() : library.prototype(kMatrixKinds[kind].type));
  JSObject* const made = JS_NewObjectWithGivenProto(context, &kMatrixClass, prototype);
  if (!made) return nullptr;
  set_matrix(made, matrix);
  JS::SetReservedSlot(made, kKindSlot, JS::Int32Value(kind));
  return made;
}

bool give(JSContext* context, const JS::CallArgs& args, const glm::dmat4& matrix, int kind) {
  JSObject* const made = make(context, matrix, kind);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}
// Returns a matrix of the kind of the called one.
bool give(JSContext* context, const JS::CallArgs& args, const glm::dmat4& matrix) {
  return give(context, args, matrix, kind_of_matrix(&args.thisv().toObject()));
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
  if (!to_field(context, value, type, 0, field)) return false;
  vrml::read_numbers(field, c);
  return true;
}

glm::dmat4 turn(const double* c) {
  const glm::dvec3 axis(c[0], c[1], c[2]);
  return glm::length(axis) > 0 ? glm::rotate(glm::dmat4(1), c[3], glm::normalize(axis)) : glm::dmat4(1);
}

// ---- Matrices of 3 rows, which transform points in the plane

glm::dmat4 shifted(double x, double y) {
  glm::dmat4 matrix(1);
  matrix[2][0] = x;
  matrix[2][1] = y;
  return matrix;
}
glm::dmat4 turned(double angle) {
  glm::dmat4 matrix(1);
  matrix[0][0] = matrix[1][1] = std::cos(angle);
  matrix[0][1] = std::sin(angle);
  matrix[1][0] = -matrix[0][1];
  return matrix;
}

// Reads an angle: a number, or the last component of an SFVec3f or an SFRotation.
bool angle_of(JSContext* context, JS::HandleValue value, double& angle) {
  double c[4] = {};
  vrml::FieldType type{};
  if (!value.isObject() || !is_tuple(&value.toObject(), type, c)) return JS::ToNumber(context, value, &angle);
  angle = c[vrml::number_count(type) - 1];
  return true;
}

bool set_plane_transform(JSContext* context, const JS::CallArgs& args) {
  double c[3][4] = {{0, 0}, {1, 1}, {0, 0}}, angles[2] = {};
  constexpr unsigned kVectors[] = {0, 2, 4}, kAngles[] = {1, 3};
  for (unsigned i = 0; i < 3; ++i)
    if (!args.get(kVectors[i]).isNullOrUndefined() &&
        !numbers_of(context, args.get(kVectors[i]), vrml::FieldType::SFVec2f, c[i]))
      return false;
  for (unsigned i = 0; i < 2; ++i)
    if (!args.get(kAngles[i]).isNullOrUndefined() && !angle_of(context, args.get(kAngles[i]), angles[i])) return false;
  glm::dmat4 scale(1);
  scale[0][0] = c[1][0];
  scale[1][1] = c[1][1];
  JS::RootedObject object(context, &args.thisv().toObject());
  set_matrix(object, shifted(c[0][0], c[0][1]) * shifted(c[2][0], c[2][1]) * turned(angles[0]) * turned(angles[1]) *
                         scale * turned(-angles[1]) * shifted(-c[2][0], -c[2][1]));
  args.rval().setUndefined();
  return matrix_changed(context, object);
}

// Sets the matrix from the fields of a Transform (6.52). Trailing arguments may be missing.
bool set_transform(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 ignored;
  if (!this_matrix(context, args, ignored)) return false;
  if (size_of(&args.thisv().toObject()) == 3) return set_plane_transform(context, args);
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

bool get_plane_transform(JSContext* context, const JS::CallArgs& args, const glm::dmat4& matrix) {
  const double translation[] = {matrix[2][0], matrix[2][1]};
  const double angle = std::atan2(matrix[0][1], matrix[0][0]);
  const double width = std::hypot(matrix[0][0], matrix[0][1]);
  const double area = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
  const double scale[] = {width, width > 0 ? area / width : 0};
  args.rval().setUndefined();
  double c[4] = {};
  vrml::FieldType type{};
  const bool is_rotation =
      args.get(1).isObject() && is_tuple(&args[1].toObject(), type, c) && type == vrml::FieldType::SFRotation;
  const double rotation[] = {0, 0, is_rotation ? 1 : angle, angle};
  return assign(context, args.get(0), translation, 2) && assign(context, args.get(1), rotation, is_rotation ? 4 : 3) &&
         assign(context, args.get(2), scale, 2);
}

// Computes the fields of a Transform. Ignores shear. A mirrored matrix gives negative scale factors.
bool get_transform(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  if (!this_matrix(context, args, matrix)) return false;
  if (size_of(&args.thisv().toObject()) == 3) return get_plane_transform(context, args, matrix);
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
  const int size = size_of(&args.thisv().toObject());
  vrml::FieldType type = size == 3 ? vrml::FieldType::SFVec2f : vrml::FieldType::SFVec3f;
  // A vector with as many components as the matrix has rows is multiplied without division.
  if (!args.get(0).isObject() || !is_tuple(&args[0].toObject(), type, c))
    if (!numbers_of(context, args.get(0), type, c)) return false;
  const int count = std::min(vrml::number_count(type), size);
  if (count < size) c[count] = 1;
  const glm::dvec4 point(c[0], c[1], c[2], size == 3 ? 0 : c[3]), result = kRow ? matrix * point : point * matrix;
  const double w = count < size && result[count] != 0 ? result[count] : 1;
  const double numbers[] = {result.x / w, result.y / w, result.z / w, result.w / w};
  JSObject* const made = make_tuple(context, type, numbers);
  args.rval().setObjectOrNull(made);
  return made != nullptr;
}

bool matrix_to_text(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix;
  if (!this_matrix(context, args, matrix)) return false;
  std::string text;
  const int size = size_of(&args.thisv().toObject());
  const vrml::FieldType type = kMatrixKinds[kind_of_matrix(&args.thisv().toObject())].type;
  const bool wide = type == vrml::FieldType::SFMatrix3d || type == vrml::FieldType::SFMatrix4d;
  for (int i = 0; i < size * size; ++i) {
    char digits[32];
    const double number = matrix[i / size][i % size];
    const auto end = wide ? std::to_chars(digits, digits + sizeof digits, number).ptr
                          : std::to_chars(digits, digits + sizeof digits, static_cast<float>(number)).ptr;
    text += (i ? " " : "") + std::string(digits, end);
  }
  return make_string(context, text, args.rval());
}

// Makes a matrix of numbers, of the rows, or of another matrix. The default is the identity.
template <int kKind>
bool construct_matrix(JSContext* context, unsigned argc, JS::Value* vp) {
  constexpr int kSize = kMatrixKinds[kKind].size;
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  glm::dmat4 matrix(1);
  if (is_matrix(args.get(0)) && size_of(&args[0].toObject()) == kSize)
    return give(context, args, matrix_of(&args[0].toObject()), kKind);
  vrml::FieldType type{};
  double c[4] = {};
  if (args.length() == kSize && args[0].isObject() && is_tuple(&args[0].toObject(), type, c)) {
    for (int row = 0; row < kSize; ++row) {
      JS::HandleValue vector = args[static_cast<unsigned>(row)];
      if (!vector.isObject() || !is_tuple(&vector.toObject(), type, c)) return fail(context, "expected a row");
      for (int i = 0; i < kSize; ++i) matrix[row][i] = c[i];
    }
    return give(context, args, matrix, kKind);
  }
  for (unsigned i = 0; i < kSize * kSize && i < args.length(); ++i) {
    double number = 0;
    if (!JS::ToNumber(context, args[i], &number)) return false;
    matrix[static_cast<int>(i) / kSize][static_cast<int>(i) % kSize] = number;
  }
  return give(context, args, matrix, kKind);
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
    JS_FN("setTransform", contained<set_transform>, 5, 0),   JS_FN("getTransform", contained<get_transform>, 3, 0),
    JS_FN("inverse", contained<inverse_matrix>, 0, 0),       JS_FN("transpose", contained<transpose>, 0, 0),
    JS_FN("multLeft", contained<mult<true>>, 1, 0),          JS_FN("multRight", contained<mult<false>>, 1, 0),
    JS_FN("multVecMatrix", contained<mult_vec<true>>, 1, 0), JS_FN("multMatrixVec", contained<mult_vec<false>>, 1, 0),
    JS_FN("toString", contained<matrix_to_text>, 0, 0),      JS_FS_END};

bool define_rows(JSContext* context, JS::HandleObject prototype) {
  return define_element(context, prototype, 0, contained<get_row<0>>, nullptr) &&
         define_element(context, prototype, 1, contained<get_row<1>>, nullptr) &&
         define_element(context, prototype, 2, contained<get_row<2>>, nullptr) &&
         define_element(context, prototype, 3, contained<get_row<3>>, nullptr);
}

template <int kKind>
bool define_kind(JSContext* context, JS::HandleObject library, std::vector<JS::PersistentRootedObject>& prototypes) {
  const MatrixKind& kind = kMatrixKinds[kKind];
  JS::RootedObject prototype(context, JS_NewPlainObject(context));
  JSFunction* const function =
      JS_NewFunction(context, contained<construct_matrix<kKind>>, static_cast<unsigned>(kind.size * kind.size),
                     JSFUN_CONSTRUCTOR, kind.name);
  JS::RootedObject constructor(context, function ? JS_GetFunctionObject(function) : nullptr);
  if (!prototype || !constructor || !JS_DefineFunctions(context, prototype, kMatrixMethods) ||
      !define_rows(context, prototype) || !JS_LinkConstructorAndPrototype(context, constructor, prototype))
    return false;
  prototypes[static_cast<std::size_t>(kind.type)] = prototype;
  return JS_DefineProperty(context, library, kind.name, constructor, 0);
}

}  // namespace

JSObject* make_matrix(JSContext* context, vrml::FieldType type, const double* numbers, Source source) {
  int kind = 1;
  while (kMatrixKinds[kind].type != type) ++kind;
  const int size = kMatrixKinds[kind].size;
  glm::dmat4 matrix(1);
  for (int i = 0; i < size * size; ++i) matrix[i / size][i % size] = numbers[i];
  JS::RootedObject parent(context, source.parent);
  JSObject* const made = make(context, matrix, kind);
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

JSObject* copy_of_matrix(JSContext* context, JS::HandleObject object) {
  return JS::GetClass(object) == &kMatrixClass ? make(context, matrix_of(object), kind_of_matrix(object)) : nullptr;
}

bool define_matrices(JSContext* context, JS::HandleObject library,
                     std::vector<JS::PersistentRootedObject>& prototypes) {
  JS::RootedObject prototype(context, JS_InitClass(context, library, nullptr, &kMatrixClass, construct_matrix<0>, 16,
                                                   nullptr, kMatrixMethods, nullptr, nullptr));
  JS::RootedObject row(context, JS_NewPlainObject(context));
  if (!prototype || !row) return false;
  set_matrix(prototype, glm::dmat4(1));
  JS::SetReservedSlot(prototype, kKindSlot, JS::Int32Value(0));
  prototypes[ScriptLibrary::kMatrixPrototype] = prototype;
  prototypes[ScriptLibrary::kRowPrototype] = row;
  return define_rows(context, prototype) &&
         define_element(context, row, 0, contained<get_number<0>>, contained<set_number<0>>) &&
         define_element(context, row, 1, contained<get_number<1>>, contained<set_number<1>>) &&
         define_element(context, row, 2, contained<get_number<2>>, contained<set_number<2>>) &&
         define_element(context, row, 3, contained<get_number<3>>, contained<set_number<3>>) &&
         define_kind<1>(context, library, prototypes) && define_kind<2>(context, library, prototypes) &&
         define_kind<3>(context, library, prototypes) && define_kind<4>(context, library, prototypes);
}

}  // namespace gs::app::script

// Ray and sphere in quadruple precision (113 bits): the truth that the double arithmetic of the library is held
// against. Its own formula, too: the roots of the quadratic of the ray, whose direction need not be of unit length.
#pragma once

#include <quadmath.h>

namespace insitu::testing {

using Quad = __float128;

struct QuadVector {
  Quad x, y, z;
  static QuadVector of(const double v[3]) { return {Quad(v[0]), Quad(v[1]), Quad(v[2])}; }
  friend QuadVector operator-(const QuadVector& a, const QuadVector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend QuadVector operator+(const QuadVector& a, const QuadVector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend QuadVector operator*(Quad s, const QuadVector& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Quad dot(const QuadVector& a, const QuadVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Quad length(const QuadVector& a) { return sqrtq(dot(a, a)); }
};

struct QuadSphereHit {
  bool hit;
  Quad enter;
  Quad leave;
  Quad offset;      // of the line of the ray from the centre
  Quad half_chord;  // 0 at a tangent
  Quad distance;    // of the centre from the ray's start
};

inline QuadSphereHit quad_sphere(const double origin[3], const double direction[3], const double centre[3],
                                 double radius) {
  const QuadVector d = QuadVector::of(direction);
  const QuadVector f = QuadVector::of(origin) - QuadVector::of(centre);
  const Quad a = dot(d, d);
  const Quad nearest = -dot(f, d) / a;
  const QuadVector p = f + nearest * d;
  const Quad r = Quad(radius);
  const Quad squares = r * r - dot(p, p);
  QuadSphereHit result{squares >= 0, 0, 0, length(p), 0, length(f)};
  if (!result.hit) return result;
  result.half_chord = sqrtq(squares);
  result.enter = nearest - sqrtq(squares / a);
  result.leave = nearest + sqrtq(squares / a);
  return result;
}

}  // namespace insitu::testing

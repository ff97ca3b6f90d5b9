#include "hal/mock/rigid_body.h"

#include <algorithm>
#include <limits>

namespace touchline::hal::mock {
namespace {

// Speed below which impacts do not bounce, so that touching bodies come to rest.
constexpr double kMinBounceMps = 0.05;
constexpr int kIterations = 8;
// Share of the overlap beyond the slop that each step removes. Removing all of it makes piles of robots jitter.
constexpr double kCorrection = 0.3, kSlopM = 0.0002;
// Ratio of a square's half diagonal to its half side, rounded up.
constexpr double kCornerReach = 1.4143;

// The vector rotated by the angle of `axis`.
Vector2 rotated(Vector2 a, Vector2 axis) { return {axis.x * a.x - axis.y * a.y, axis.y * a.x + axis.x * a.y}; }

Vector2 to_local(const Square& square, Vector2 point) {
  return rotated(point - square.body->position, Vector2{square.axis.x, -square.axis.y});
}

bool is_inside(const Square& square, Vector2 point) {
  const Vector2 local = to_local(square, point);
  return std::abs(local.x) <= square.half_side_m && std::abs(local.y) <= square.half_side_m;
}

void add(Contacts& out, Body* a, Body* b, Vector2 point, Vector2 normal, double depth_m, Surface surface) {
  Contact contact;
  contact.a = a;
  contact.b = b;
  contact.point = point;
  contact.normal = normal;
  contact.depth_m = depth_m;
  contact.restitution = surface.restitution;
  contact.friction = surface.friction;
  out.push_back(contact);
}

// Returns the parameter of the point's projection on the line through `begin` (0) and `end` (1).
double line_parameter(Vector2 begin, Vector2 end, Vector2 point) {
  const Vector2 way = end - begin;
  return dot(point - begin, way) / dot(way, way);
}

Vector2 nearest_on_segment(Vector2 begin, Vector2 end, Vector2 point) {
  return begin + std::clamp(line_parameter(begin, end, point), 0.0, 1.0) * (end - begin);
}

// The point of the walls that is nearest to a given point.
struct BoundaryPoint {
  Vector2 point, inward_normal;  // nearest point, and the normal of its wall
  double distance_m = 0.0;
};

BoundaryPoint nearest_boundary_point(const Outline& outline, Vector2 point) {
  BoundaryPoint best;
  std::size_t wall = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2 nearest = nearest_on_segment(outline[i], outline[(i + 1) % outline.size()], point);
    const double square = dot(point - nearest, point - nearest);
    if (square >= least) continue;
    least = square;
    best.point = nearest;
    wall = i;
  }
  const Vector2 way = outline[(wall + 1) % outline.size()] - outline[wall];
  best.inward_normal = (1.0 / length(way)) * perpendicular(way);
  best.distance_m = std::sqrt(least);
  return best;
}

// Returns the unit vector from a point outside the walls to its nearest boundary point. If they coincide, the wall's
// normal.
Vector2 inward_normal(const BoundaryPoint& boundary, Vector2 point) {
  return boundary.distance_m > 1e-9 ? (1.0 / boundary.distance_m) * (boundary.point - point) : boundary.inward_normal;
}

// Distance of a point inside a square from the nearest side.
struct Penetration {
  Vector2 normal;  // outward normal of this side, in the field frame
  double depth_m = 0.0;
};
Penetration nearest_side(const Square& square, Vector2 point) {
  const Vector2 local = to_local(square, point);
  const double gap_x = square.half_side_m - std::abs(local.x), gap_y = square.half_side_m - std::abs(local.y);
  const Vector2 normal =
      gap_x < gap_y ? Vector2{local.x < 0.0 ? -1.0 : 1.0, 0.0} : Vector2{0.0, local.y < 0.0 ? -1.0 : 1.0};
  return {rotated(normal, square.axis), std::min(gap_x, gap_y)};
}

ContactAxis contact_axis(const Contact& contact, const Body& b, Vector2 direction) {
  ContactAxis axis;
  axis.direction = direction;
  axis.arm_a_m = cross(contact.point - contact.a->position, direction);
  axis.arm_b_m = cross(contact.point - b.position, direction);
  axis.mass_kg = 1.0 / (contact.a->inverse_mass + contact.a->inverse_inertia * axis.arm_a_m * axis.arm_a_m +
                        b.inverse_mass + b.inverse_inertia * axis.arm_b_m * axis.arm_b_m);
  return axis;
}

// Speed of a relative to b at the contact, along the axis.
double relative_speed(const ContactAxis& axis, const Body& a, const Body& b) {
  return dot(a.velocity - b.velocity, axis.direction) + a.w * axis.arm_a_m - b.w * axis.arm_b_m;
}

// Adds to the accumulated impulse of the axis what gives the relative speed `wanted_mps`, within these limits.
void push(ContactAxis& axis, Body& a, Body& b, double wanted_mps, double low_ns, double high_ns) {
  const double missing = (wanted_mps - relative_speed(axis, a, b)) * axis.mass_kg;
  const double sum = std::clamp(axis.impulse_ns + missing, low_ns, high_ns), change = sum - axis.impulse_ns;
  axis.impulse_ns = sum;
  a.velocity = a.velocity + change * a.inverse_mass * axis.direction;
  a.w += change * a.inverse_inertia * axis.arm_a_m;
  b.velocity = b.velocity - change * b.inverse_mass * axis.direction;
  b.w -= change * b.inverse_inertia * axis.arm_b_m;
}

}  // namespace

std::array<Vector2, 4> corners(const Square& square) {
  const Vector2 ahead = square.half_side_m * square.axis;
  const Vector2 left = perpendicular(ahead);
  const Vector2 p = square.body->position;
  return {p + ahead + left, p - ahead + left, p - ahead - left, p + ahead - left};
}

bool is_inside(const Outline& outline, Vector2 point) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2 a = outline[i], b = outline[(i + 1) % outline.size()];
    // Even-odd rule: counts the walls that the ray from the point along +x crosses.
    if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
      inside = !inside;
    }
  }
  return inside;
}

void collide(const Square& a, const Square& b, Surface surface, Contacts& out) {
  const Vector2 between = a.body->position - b.body->position;
  const double reach = (a.half_side_m + b.half_side_m) * kCornerReach;
  if (dot(between, between) > reach * reach) return;
  // Separating axis test over the side normals of both squares. The axis of least overlap becomes the contact normal.
  // The axis is turned so that it points from b to a.
  double least = std::numeric_limits<double>::max();
  Vector2 normal;
  // Half the extent of each square along the axes of the other one.
  const double turned = std::abs(dot(a.axis, b.axis)) + std::abs(cross(a.axis, b.axis));
  for (int i = 0; i < 4; ++i) {
    const Vector2 ahead = (i < 2 ? a : b).axis;
    Vector2 axis = i % 2 == 0 ? ahead : perpendicular(ahead);
    double apart = dot(axis, between);
    if (apart < 0.0) {
      axis = -axis;
      apart = -apart;
    }
    const double overlap =
        (i < 2 ? a.half_side_m + turned * b.half_side_m : b.half_side_m + turned * a.half_side_m) - apart;
    if (overlap <= 0.0) return;
    if (overlap < least) {
      least = overlap;
      normal = axis;
    }
  }
  const std::size_t before = out.size();
  const std::array<Vector2, 4> of_a = corners(a), of_b = corners(b);
  double lowest_a = std::numeric_limits<double>::max(), highest_b = std::numeric_limits<double>::lowest();
  for (const Vector2& corner : of_a) lowest_a = std::min(lowest_a, dot(corner, normal));
  for (const Vector2& corner : of_b) highest_b = std::max(highest_b, dot(corner, normal));
  for (const Vector2& corner : of_a) {
    if (is_inside(b, corner)) add(out, a.body, b.body, corner, normal, highest_b - dot(corner, normal), surface);
  }
  for (const Vector2& corner : of_b) {
    if (is_inside(a, corner)) add(out, a.body, b.body, corner, normal, dot(corner, normal) - lowest_a, surface);
  }
  // Two squares that overlap deeply, for example at a bad start, can intersect without a corner of one inside the
  // other.
  if (out.size() == before)
    add(out, a.body, b.body, 0.5 * (a.body->position + b.body->position), normal, least, surface);
}

void collide(const Square& a, const Outline& walls, Surface surface, Contacts& out) {
  const double reach = a.half_side_m * kCornerReach;
  if (is_inside(walls, a.body->position) && nearest_boundary_point(walls, a.body->position).distance_m > reach) return;
  for (const Vector2& corner : corners(a)) {
    if (is_inside(walls, corner)) continue;
    const BoundaryPoint boundary = nearest_boundary_point(walls, corner);
    add(out, a.body, nullptr, corner, inward_normal(boundary, corner), boundary.distance_m, surface);
  }
  // A reflex corner of the walls (a goal post) can enter the square between the square's corners.
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vector2 before = walls[i], post = walls[(i + 1) % walls.size()], after = walls[(i + 2) % walls.size()];
    if (cross(post - before, after - post) >= 0.0 || !is_inside(a, post)) continue;
    const Penetration penetration = nearest_side(a, post);
    add(out, a.body, nullptr, post, -penetration.normal, penetration.depth_m, surface);
  }
}

void collide(const Circle& a, const Square& b, Surface surface, Contacts& out) {
  const Vector2 between = a.body->position - b.body->position;
  const double reach = a.radius_m + b.half_side_m * kCornerReach;
  if (dot(between, between) > reach * reach) return;
  if (is_inside(b, a.body->position)) {
    const Penetration penetration = nearest_side(b, a.body->position);
    add(out, a.body, b.body, a.body->position, penetration.normal, penetration.depth_m + a.radius_m, surface);
    return;
  }
  const Vector2 local = to_local(b, a.body->position);
  const Vector2 nearest_local{std::clamp(local.x, -b.half_side_m, b.half_side_m),
                              std::clamp(local.y, -b.half_side_m, b.half_side_m)};
  const Vector2 nearest = b.body->position + rotated(nearest_local, b.axis);
  const Vector2 gap = a.body->position - nearest;
  const double distance = length(gap);
  if (distance >= a.radius_m || distance <= 0.0) return;
  add(out, a.body, b.body, nearest, (1.0 / distance) * gap, a.radius_m - distance, surface);
}

void collide(const Circle& a, const Outline& walls, Surface surface, Contacts& out) {
  const Vector2 center = a.body->position;
  if (!is_inside(walls, center)) {
    const BoundaryPoint boundary = nearest_boundary_point(walls, center);
    add(out, a.body, nullptr, boundary.point, inward_normal(boundary, center), boundary.distance_m + a.radius_m,
        surface);
    return;
  }
  double previous_parameter = line_parameter(walls.back(), walls[0], center);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vector2 begin = walls[i], end = walls[(i + 1) % walls.size()];
    const double parameter = line_parameter(begin, end, center);
    // The wall's first corner counts only if the projection lies beyond the end of the previous wall; otherwise the
    // previous wall already gives the contact.
    const bool faces = parameter < 1.0 && (parameter > 0.0 || previous_parameter >= 1.0);
    previous_parameter = parameter;
    if (!faces) continue;
    const Vector2 nearest = nearest_on_segment(begin, end, center), gap = center - nearest;
    const double distance = length(gap);
    if (distance >= a.radius_m || distance <= 0.0) continue;
    add(out, a.body, nullptr, nearest, (1.0 / distance) * gap, a.radius_m - distance, surface);
  }
}

void resolve(Contacts& contacts) {
  Body wall;  // its inverse mass of 0 keeps it at rest
  const auto body_b = [&](const Contact& contact) -> Body& { return contact.b != nullptr ? *contact.b : wall; };
  for (Contact& contact : contacts) {
    const Body& b = body_b(contact);
    contact.across = contact_axis(contact, b, contact.normal);
    contact.along = contact_axis(contact, b, perpendicular(contact.normal));
    const double approach = -relative_speed(contact.across, *contact.a, b);
    contact.bounce_mps = approach > kMinBounceMps ? contact.restitution * approach : 0.0;
  }
  for (int i = 0; i < kIterations; ++i) {
    for (Contact& contact : contacts) {
      Body& b = body_b(contact);
      push(contact.across, *contact.a, b, contact.bounce_mps, 0.0, std::numeric_limits<double>::max());
      const double limit = contact.friction * contact.across.impulse_ns;
      push(contact.along, *contact.a, b, 0.0, -limit, limit);
    }
  }
  for (const Contact& contact : contacts) {
    const double excess = contact.depth_m - kSlopM;
    if (excess <= 0.0) continue;
    Body& b = body_b(contact);
    const double share = kCorrection * excess / (contact.a->inverse_mass + b.inverse_mass);
    contact.a->position = contact.a->position + share * contact.a->inverse_mass * contact.normal;
    b.position = b.position - share * b.inverse_mass * contact.normal;
  }
}

}  // namespace touchline::hal::mock

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/fixed_vector.h"
#include "core/geometry/vector2.h"

// Rigid bodies in the plane: collision detection of squares, a circle and walls, and the contact solver.
namespace touchline::hal::mock {

/// Faster than norm(), whose protection from overflow is not needed here.
inline double length(Vector2 a) { return std::sqrt(dot(a, a)); }

/// State of a rigid body in SI units. `w`: angular velocity, counter-clockwise.
struct Body {
  Vector2 position, velocity;
  double theta = 0.0, w = 0.0;
  double inverse_mass = 0.0, inverse_inertia = 0.0;
};

/// A square centered on its body and rotated with it. `axis`: its unit vector of x, for the angle of the body; who has
/// it already hands it over.
struct Square {
  Body* body = nullptr;
  double half_side_m = 0.0;
  Vector2 axis = unit_vector(body->theta);
};

/// The corners, counter-clockwise from the front left one.
std::array<Vector2, 4> corners(const Square& square);

struct Circle {
  Body* body = nullptr;
  double radius_m = 0.0;
};

/// The walls: corners of a closed polygon around the field, counter-clockwise. Neighboring corners must differ.
using Outline = FixedVector<Vector2, 24>;
bool is_inside(const Outline& outline, Vector2 point);

/// The solver's view of one direction of a contact.
struct ContactAxis {
  Vector2 direction;
  double arm_a_m = 0.0, arm_b_m = 0.0;  // levers of an impulse in this direction about the centers of a and b
  double mass_kg = 0.0;                 // impulse in this direction that changes the relative velocity by 1 m/s
  double impulse_ns = 0.0;              // accumulated
};

/// Contact of two bodies. `b` null: a wall. The normal points from b to a.
struct Contact {
  Body* a = nullptr;
  Body* b = nullptr;
  Vector2 point, normal;
  double depth_m = 0.0;
  double restitution = 0.0, friction = 0.0;
  double bounce_mps = 0.0;  // wanted speed of separation
  ContactAxis across, along;
};

// A robot in a corner between ten others has about a dozen contacts; 22 robots in one heap have 150.
using Contacts = FixedVector<Contact, 512>;

struct Surface {
  double restitution = 0.0, friction = 0.0;
};

/// Append the contacts of a pair, if it touches. For a body outside the walls, the contact normal is the shortest way
/// back.
void collide(const Square& a, const Square& b, Surface surface, Contacts& out);
void collide(const Square& a, const Outline& walls, Surface surface, Contacts& out);
void collide(const Circle& a, const Square& b, Surface surface, Contacts& out);
void collide(const Circle& a, const Outline& walls, Surface surface, Contacts& out);

/// Applies sequential impulses with accumulated clamping (Catto, "Iterative Dynamics with Temporal Coherence", GDC
/// 2005), then removes a part of the remaining overlap from the positions.
void resolve(Contacts& contacts);

}  // namespace touchline::hal::mock

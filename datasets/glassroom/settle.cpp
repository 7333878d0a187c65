// SPDX-License-Identifier: MIT
#include "datasets/glassroom/settle.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "glint/core/error.h"
#include "glint/scene/camera.h"

namespace glint {

namespace {

constexpr float kMargin = 0.001f;  // metres, of collision hulls
constexpr float kWallThickness =
    0.06f;  // panes collide as thick walls, grown outwards: no tunnelling
constexpr float kInnerWallThickness = 0.012f;          // thin: what lies beside the case touches it
constexpr float kContainerMass = 40, kInnerMass = 10;  // kg

btVector3 to_bullet(Vec3f v) { return {v.x, v.y, v.z}; }
Vec3f from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform to_bullet(const Pose& pose) {
  const auto& r = pose.rotation.rows;
  return btTransform(
      btMatrix3x3(r[0].x, r[0].y, r[0].z, r[1].x, r[1].y, r[1].z, r[2].x, r[2].y, r[2].z),
      to_bullet(pose.translation)
  );
}

Pose from_bullet(const btTransform& transform) {
  const btMatrix3x3& m = transform.getBasis();
  return {
      .rotation = {{from_bullet(m[0]), from_bullet(m[1]), from_bullet(m[2])}},
      .translation = from_bullet(transform.getOrigin())};
}

// A Bullet world with the bodies that live in it. Shapes are kept until the world is gone.
class World {
 public:
  World() {
    dynamics_.setGravity({0, 0, -9.81f});
    // Islands in a fixed order and no warm start from addresses: runs repeat to the bit.
    dynamics_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  }
  ~World() {
    for (const auto& body : bodies_) dynamics_.removeRigidBody(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  template <class Shape, class... Args>
  Shape* shape(Args&&... args) {
    auto owned = std::make_unique<Shape>(std::forward<Args>(args)...);
    Shape* result = owned.get();
    result->setMargin(kMargin);
    shapes_.push_back(std::move(owned));
    return result;
  }

  btRigidBody* add(btCollisionShape* shape, float mass, const btTransform& pose, float friction) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = pose;
    info.m_friction = friction;
    info.m_rollingFriction = 0.02f;
    info.m_spinningFriction = 0.02f;
    info.m_linearDamping = 0.05f;
    info.m_angularDamping = 0.15f;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    dynamics_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  void step(double seconds) { dynamics_.stepSimulation(static_cast<btScalar>(seconds), 0); }

  bool asleep() const {
    for (const auto& body : bodies_)
      if (!body->isStaticObject() && body->isActive()) return false;
    return true;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld dynamics_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

btTransform at(Vec3f translation) { return to_bullet(translated(translation)); }

// Bullet wants the origin at the centre of mass: the middle of the box.
btCollisionShape* container_shape(World& world, const ContainerShape& shape, float wall) {
  auto* compound = world.shape<btCompoundShape>();
  const Vec3f middle{0, 0, 0.5f * shape.size.z};
  for (const Bounds& beam : container_beams(shape))
    compound->addChildShape(
        at(beam.center() - middle), world.shape<btBoxShape>(to_bullet(0.5f * beam.size()))
    );
  for (const Pane& pane : container_panes(shape)) {
    Vec3f center = pane.center - middle, half = pane.half_size;
    if (pane.axis == 2 && center.z < 0) {
      // The underside cannot grow: it stands on the floor.
      const float top = center.z + half.z, bottom = -middle.z;
      half.z = 0.5f * (top - bottom);
      center.z = 0.5f * (top + bottom);
    } else {
      center[pane.axis] += std::copysign(wall - half[pane.axis], center[pane.axis]);
      half[pane.axis] = wall;
    }
    compound->addChildShape(at(center), world.shape<btBoxShape>(to_bullet(half)));
  }
  return compound;
}

btCollisionShape* object_shape(World& world, const ContainerObject& object) {
  auto* compound = world.shape<btCompoundShape>();
  for (const std::vector<Vec3f>& hull : object.hulls) {
    auto* convex = world.shape<btConvexHullShape>();
    for (const Vec3f point : hull) convex->addPoint(to_bullet(point), false);
    convex->recalcLocalAabb();
    compound->addChildShape(btTransform::getIdentity(), convex);
  }
  return compound;
}

float bounding_radius(const ContainerObject& object) {
  float radius2 = 0;
  for (const Vec3f vertex : object.mesh.vertices) radius2 = std::max(radius2, length2(vertex));
  return std::sqrt(radius2);
}

Mat3f random_upright(Rng& rng) {
  const float tilt = 0.12f;
  const Vec4<double> q{
      1,
      static_cast<double>(rng.uniform(-tilt, tilt)),
      static_cast<double>(rng.uniform(-tilt, tilt)),
      static_cast<double>(rng.uniform(-2, 2))};
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return cast<float>(rotation_from_quaternion({q.w / norm, q.x / norm, q.y / norm, q.z / norm}));
}

// From a point of the outer case's frame to the inner case.
float distance_to(const InnerCase& inner, Vec3f point) {
  const Vec3f local = transpose_times(inner.start.rotation, point - inner.start.translation);
  const Vec3f half = 0.5f * inner.shape.size;
  const auto beyond = [](float value, float low, float high) {
    return std::max({low - value, value - high, 0.0f});
  };
  return length(Vec3f{
      beyond(local.x, -half.x, half.x),
      beyond(local.y, -half.y, half.y),
      beyond(local.z, 0, inner.shape.size.z)});
}

// The lowest of many random places where the object's bounding sphere touches neither the container
// nor the case in it (if any) nor the spheres placed before.
bool find_start(
    const ContainerShape& shape,
    const InnerCase* inner,
    const std::vector<Vec4f>& placed,
    float radius,
    Rng& rng,
    Vec3f& place
) {
  constexpr int kTries = 4000;
  const float rim = shape.beam + radius + 0.005f;
  const Vec3f reach{0.5f * shape.size.x - rim, 0.5f * shape.size.y - rim, shape.size.z - rim};
  bool found = false;
  if (reach.x < 0 || reach.y < 0 || reach.z < rim) return false;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const float x = rng.uniform(-reach.x, reach.x), y = rng.uniform(-reach.y, reach.y);
    const Vec3f trial{x, y, rng.uniform(rim, reach.z)};
    if (found && trial.z >= place.z) continue;
    if (inner != nullptr && distance_to(*inner, trial) < radius + 0.02f) continue;
    const bool free = std::all_of(placed.begin(), placed.end(), [&](Vec4f other) {
      return length(trial - Vec3f{other.x, other.y, other.z}) > radius + other.w;
    });
    if (free) place = trial;
    found = found || free;
  }
  return found;
}

// The largest are placed first.
std::vector<Pose> start_poses(
    const ContainerShape& shape,
    const std::vector<ContainerObject>& objects,
    const InnerCase* inner,
    Rng& rng
) {
  std::vector<std::size_t> order(objects.size());
  std::vector<float> radii;
  for (const ContainerObject& object : objects) radii.push_back(bounding_radius(object));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return radii[a] > radii[b];
  });
  std::vector<Pose> poses(objects.size());
  std::vector<Vec4f> placed;  // centre and radius (w)
  for (const std::size_t i : order) {
    Vec3f place{};
    GLINT_CHECK(
        find_start(shape, inner, placed, radii[i], rng, place),
        kEnvironment,
        "settle: no space in the container for the {} after {} objects",
        objects[i].name,
        placed.size()
    );
    placed.push_back({radii[i], place.x, place.y, place.z});
    poses[i] = {.rotation = random_upright(rng), .translation = place};
  }
  return poses;
}

// Object origins within the case, which is upright.
void check_case(
    const ContainerShape& shape,
    const Pose& pose,
    const std::vector<Pose>& objects,
    const char* name
) {
  GLINT_CHECK(pose.rotation.rows[2].z > 0.999f, kEnvironment, "settle: the {} fell over", name);
  const Vec3f half = 0.5f * shape.size;
  const Bounds inside{.low = {-half.x, -half.y, 0}, .high = {half.x, half.y, shape.size.z}};
  for (const Pose& object : objects)
    GLINT_CHECK(
        inside.contains(transpose_times(pose.rotation, object.translation - pose.translation)),
        kEnvironment,
        "settle: an object left the {}",
        name
    );
}

// A case in the world and what is in it.
class Case {
 public:
  Case(
      World& world,
      const ContainerShape& shape,
      const Pose& start,
      float mass,
      float wall,
      float friction
  )
      : start_(start), middle_{0, 0, 0.5f * shape.size.z}, friction_(friction) {
    box_ = world.add(
        container_shape(world, shape, wall),
        mass,
        to_bullet(compose(start, translated(middle_))),
        friction
    );
  }

  // `places`: in the case.
  void fill(
      World& world, const std::vector<ContainerObject>& objects, const std::vector<Pose>& places
  ) {
    for (std::size_t i = 0; i < objects.size(); ++i)
      bodies_.push_back(world.add(
          object_shape(world, objects[i]),
          objects[i].mass,
          to_bullet(compose(start_, places[i])),
          friction_
      ));
  }

  Pose pose() const {
    return compose(from_bullet(box_->getWorldTransform()), translated(-middle_));
  }
  std::vector<Pose> objects() const {
    std::vector<Pose> poses;
    for (const btRigidBody* body : bodies_) poses.push_back(from_bullet(body->getWorldTransform()));
    return poses;
  }

 private:
  Pose start_;
  Vec3f middle_;
  float friction_;
  btRigidBody* box_ = nullptr;
  std::vector<btRigidBody*> bodies_;
};

void add_floor(World& world, const SettleOptions& options) {
  constexpr float kFloor = 5;
  world.add(
      world.shape<btBoxShape>(btVector3(kFloor, kFloor, 0.5f)),
      0,
      at({0, 0, options.support_height - 0.5f}),
      options.floor_friction
  );
}

}  // namespace

SettleResult settle(
    const ContainerShape& shape,
    const std::vector<ContainerObject>& objects,
    const SettleOptions& options,
    Rng& rng,
    const InnerCase* inner
) {
  World world;
  add_floor(world, options);
  const Pose start = yawed(
      options.yaw, {options.place.x, options.place.y, options.support_height + options.drop_height}
  );
  Case outer(world, shape, start, kContainerMass, kWallThickness, options.body_friction);
  outer.fill(world, objects, start_poses(shape, objects, inner, rng));
  std::optional<Case> in;
  if (inner != nullptr) {
    const Pose inner_start = compose(start, inner->start);
    in.emplace(
        world, inner->shape, inner_start, kInnerMass, kInnerWallThickness, options.body_friction
    );
    in->fill(world, inner->objects, start_poses(inner->shape, inner->objects, nullptr, rng));
  }
  SettleResult result;
  const int max_steps = static_cast<int>(options.max_seconds * options.step_hz);
  while (result.num_steps < max_steps && !(result.at_rest = world.asleep())) {
    world.step(1 / options.step_hz);
    ++result.num_steps;
  }
  result.container = outer.pose();
  result.objects = outer.objects();
  check_case(shape, result.container, result.objects, "container");
  if (in) {
    result.inner_case = in->pose();
    result.inner_objects = in->objects();
    check_case(shape, result.container, {result.inner_case}, "container");
    check_case(inner->shape, result.inner_case, result.inner_objects, "inner case");
  }
  return result;
}

}  // namespace glint

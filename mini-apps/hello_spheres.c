/* The shortest host: a sunflower of balls that a wave runs through, drawn while it moves. */
#include <insitu/insitu.h>
#include <math.h>
#include <stdio.h>

enum { BALLS = 3000, STEPS = 24 };
struct ball { /* whatever a simulation keeps of a ball; the library reads the fields it is told of where they are */
  double position[3], speed;
  float radius;
} balls[BALLS];

static void move_balls(double time) {
  for (int i = 0; i < BALLS; i++) {
    double distance = sqrt(i + 0.5), angle = 2.399963229728653 * i; /* the golden angle, in radians */
    double crest = 4.0 * exp(-0.03 * distance), phase = 0.35 * distance - time;
    balls[i] = (struct ball){.position = {distance * cos(angle), distance * sin(angle), crest * sin(phase)},
                             .speed = fabs(crest * cos(phase)),
                             .radius = (float)(0.55 + 0.004 * distance)};
  }
}

int main(void) {
  insitu_context context;
  if (insitu_context_create(NULL, &context) != INSITU_OK) return fprintf(stderr, "%s\n", insitu_error_text(NULL)), 1;

  /* What there is to see, and how it looks. Every struct starts with its size, and zero means the default. */
  insitu_array position = insitu_array_records(INSITU_F64, 3, balls[0].position, BALLS, sizeof balls[0]);
  insitu_array radius = insitu_array_records(INSITU_F32, 1, &balls[0].radius, BALLS, sizeof balls[0]);
  insitu_array speed = insitu_array_records(INSITU_F64, 1, &balls[0].speed, BALLS, sizeof balls[0]);
  insitu_attribute attribute = {"speed", &speed};
  insitu_particles_desc particles = {sizeof particles, .name = "balls"};
  insitu_geometry geometry;
  insitu_particles_create(context, &particles, &geometry);
  insitu_style style = {sizeof style, INSITU_COLOR_ATTRIBUTE, .attribute = "speed"};
  insitu_geometry_set_style(context, geometry, &style);

  /* From where, in which light, on how many pixels. */
  insitu_camera camera = {sizeof camera, .eye = {0, -75, 60}, .up = {0, 0, 1}, .fov_y_deg = 40};
  insitu_effects effects = {sizeof effects, INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION, .ao_samples = 16};
  insitu_view_desc view_desc = {sizeof view_desc, .camera = &camera, .effects = &effects};
  insitu_view view;
  insitu_view_create(context, &view_desc, &view);
  insitu_image_desc image_desc = {sizeof image_desc, .width = 1024, .height = 576};
  insitu_image image;
  insitu_image_create(context, &image_desc, &image);

  particles.position = &position, particles.radius = &radius;
  particles.attributes = &attribute, particles.attribute_count = 1;
  for (int step = 0; step < STEPS; step++) {
    move_balls(step * 6.283185307179586 / STEPS);
    insitu_step_begin(context, (uint64_t)step, step);
    insitu_particles_update(context, geometry, &particles); /* lends the arrays to the library until step_end */
    insitu_commit(context);
    insitu_render(context, view, image);
    insitu_image_write(context, image, "hello_{step:3}.png");
    if (insitu_step_end(context) != INSITU_OK) fprintf(stderr, "step %d: %s\n", step, insitu_error_text(context));
  }
  insitu_context_destroy(context);
}

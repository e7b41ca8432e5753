# Becalm in one image: the console, the emulated robot, the router between them, and the workers of a cluster.
#
#   docker build -t becalm .
#   buildah build --format docker -t becalm .
#
# Registries other than the public ones, and a private certificate authority, come in as secrets, which no layer keeps:
#   --secret id=ca,src=company-ca.pem  --secret id=pip,src=pip.conf  --secret id=npm,src=.npmrc
ARG PYTHON_IMAGE=docker.io/library/python:3.11-slim-bookworm

# pip stays in the stages that build: it installs into environments that have none.
FROM ${PYTHON_IMAGE} AS tools
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1 PIP_ROOT_USER_ACTION=ignore
RUN python3 -m venv /opt/pip && python3 -m venv --without-pip /opt/python
COPY deploy/container/with-secrets /usr/local/bin/

# What the console and the service are built from; Node comes with pip, and stays in this stage.
FROM tools AS wheel
WORKDIR /src
COPY requirements.lock pyproject.toml README.md LICENSE ./
COPY becalm becalm
COPY sim sim
COPY server server
COPY web web
COPY docs docs
RUN --mount=type=secret,id=ca --mount=type=secret,id=pip --mount=type=secret,id=npm \
    PIP_CONSTRAINT=/src/requirements.lock with-secrets /opt/pip/bin/pip wheel --quiet --no-deps --wheel-dir /wheels .

# What Becalm needs, nine tenths of it all, in a layer of its own: no change of the sources sends it again.
FROM tools AS dependencies
COPY requirements.lock pyproject.toml /src/
COPY deploy/container/requirements.py /usr/local/bin/
RUN python3 /usr/local/bin/requirements.py /src/pyproject.toml cluster > /src/requirements.txt
RUN --mount=type=secret,id=ca --mount=type=secret,id=pip \
    with-secrets /opt/pip/bin/pip --python /opt/python install --quiet --no-compile --only-binary :all: \
    --constraint /src/requirements.lock --requirement /src/requirements.txt
# Whole seconds, the same for all files: layers keep no more, and numba and Python know compiled code by these times.
# Some packages carry sources for other versions of Python, which do not compile; all that can is. Their own tests, a
# tenth of it all, nobody runs here. Becalm itself lies outside, where a .pth file has Python look.
RUN find /opt/python/lib -type d -name tests -prune -exec rm -rf {} + \
    && (cd /opt/python/lib/python3*/site-packages && echo /opt/becalm > becalm.pth) \
    && find /opt/python -exec touch --no-dereference --date=@1700000000 {} + \
    && { /opt/python/bin/python -m compileall -q -j 0 /opt/python/lib > /dev/null || true; } \
    && find /opt/python -exec touch --no-dereference --date=@1700000000 {} +

FROM dependencies AS installed
COPY --from=wheel /wheels /wheels
RUN /opt/pip/bin/pip --python /opt/python install --quiet --no-compile --no-deps --no-index \
    --target /opt/becalm /wheels/*.whl \
    && find /opt/becalm -exec touch --no-dereference --date=@1700000000 {} + \
    && /opt/python/bin/python -m compileall -q -j 0 /opt/becalm \
    && find /opt/becalm -exec touch --no-dereference --date=@1700000000 {} +
# The simulation, compiled for the processor that builds; on another one the first start compiles it again.
RUN NUMBA_CACHE_DIR=/opt/compiled /opt/python/bin/python -c "from sim.capture.mission import prepare; from sim.configurations import DEFAULT_CONFIGURATION, named_configuration; prepare(named_configuration(DEFAULT_CONFIGURATION))"

FROM ${PYTHON_IMAGE}
LABEL org.opencontainers.image.title="Becalm" \
    org.opencontainers.image.description="Mission console for a dual-arm free-flying robot" \
    org.opencontainers.image.licenses="MIT"
RUN useradd --uid 10001 --no-create-home --home-dir /tmp --shell /usr/sbin/nologin becalm \
    && install --directory --owner=becalm --mode=0700 /data
COPY --from=dependencies /opt/python /opt/python
COPY --from=installed /opt/becalm /opt/becalm
COPY --from=installed /opt/compiled /opt/compiled
COPY deploy/container/start deploy/container/healthy deploy/container/router /opt/becalm/bin/
# Only /data and /tmp are written to: the root file system may be read-only.
ENV PATH=/opt/becalm/bin:/opt/python/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    HOME=/tmp \
    MPLCONFIGDIR=/tmp/matplotlib \
    NUMBA_CACHE_DIR=/tmp/compiled \
    BECALM_HOST=0.0.0.0 \
    BECALM_DATA_DIR=/data \
    BECALM_LOG_FORMAT=json \
    BECALM_LOG_LEVEL=info
USER 10001:10001
VOLUME /data
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=5s --start-period=120s --retries=3 CMD ["healthy", "console"]
ENTRYPOINT ["start"]
CMD ["becalm", "serve", "--no-open"]

# polycnc with all it compiles compiled for any processor of this kind: starts warm, runs as any user, writes to /work alone.
# docker build -t polycnc . && docker run --rm -v "$PWD:/work" polycnc run part.nc
# Machines that are served: examples/containers/compose.yaml
FROM python:3.12-slim
ENV POLYCNC_CACHE_DIR=/opt/polycnc-cache NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES= PYTHONUNBUFFERED=1
COPY . /src
RUN pip install --no-cache-dir '/src[cluster,opcua,parquet,plot,serve,yaml]' && rm -rf /src
RUN polycnc warmup all && chmod -R a+rX /opt/polycnc-cache
RUN mkdir -p /work && chmod 1777 /work
EXPOSE 4840 5000 7878-7880 8080 8123 8193 8194
USER 65534:65534
WORKDIR /work
ENTRYPOINT ["polycnc"]
